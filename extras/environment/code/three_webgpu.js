// For three.js and its WebGPURenderer; tried with release 185.
import { EnvironmentNode, LightingModel, MeshStandardNodeMaterial } from 'three/webgpu';
import { cameraViewMatrix, cross, diffuseColor, float, int, luminance, mat3, materialEnvIntensity, materialReference, mix, normalView, pmremTexture,
         positionView, positionViewDirection, vec3, vec4, wgsl, wgslFn } from 'three/tsl';

const functions = wgsl(/* wgsl */ `
FUNCTIONS`);

// The functions of a model as nodes.
function nodesOf(name) {
    const view = wgsl(`var<private> three_shapes_of_${name}: array<vec4f, LOBES>;\nvar<private> three_weights_of_${name}: array<vec3f, LOBES>;\n`);
    const node = (head, body) => wgslFn(`fn three_${head.replace('(', `_of_${name}(`)} { ${body} }`, [functions, view]);
    return {
        brdf: node('brdf(wl: vec3f, wv: vec3f) -> vec3f', `return ${name}_brdf(wl, wv);`),
        albedo: node('albedo(cosine: f32) -> vec3f', `return ${name}_albedo(cosine);`),
        area: node('area(wv: vec3f, a: vec3f, b: vec3f, c: vec3f, d: vec3f) -> vec3f', `return ${name}_area(wv, a, b, c, d);`),
        // The terms of the environment for a view, which this sets: their axes and roughnesses, and weights.
        view: node('view(wv: vec3f) -> f32', `let lobes = ${name}_lobes_about(wv);
            for (var k = 0; k < LOBES; k++) {
                three_shapes_of_${name}[k] = vec4f(lobes.lobe[k].axis, lobes.lobe[k].roughness);
                three_weights_of_${name}[k] = lobes.lobe[k].weight;
            }
            return 0.0;`),
        shape: node('shape(k: i32, view: f32) -> vec4f', `return three_shapes_of_${name}[k];`),
        weight: node('weight(k: i32, view: f32) -> vec3f', `return three_weights_of_${name}[k];`),
    };
}

// The roughness at which release 185 looks up a map that is as blurred as the kernel of a lobe of roughness r. That release
// filters by a chain of GGX convolutions, whose product is another kernel. This is fitted to the Legendre spectra of chains
// of 9 to 11 levels, within 0.03.
const lookedUp = (r) => r.mul(float(1.4).sub(r.mul(0.15)).sub(r.pow(3).mul(0.3)));

// Reflects the lights of three by the functions of a model. What all lights share is evaluated once for a pixel.
class MeasuredLighting extends LightingModel {
    constructor(nodes) {
        super();
        this.nodes = nodes;
        this.environment = null;  // the filtered environment, if there is one
    }
    start(builder) {
        const wv = positionViewDirection, inView = (x, y, z) => cameraViewMatrix.mul(vec4(x, y, z, 0)).xyz;
        // The normal is made visible to the viewer; x is along the circle of latitude around y.
        const n = normalView.add(wv.mul(normalView.dot(wv).oneMinus().sub(0.99).max(0))).normalize().toVar();
        const latitude = cross(inView(0, 1, 0), n);
        const x = latitude.dot(latitude).greaterThan(1e-12).select(latitude, cross(n, inView(0, 0, 1))).normalize().toVar();
        this.frame = mat3(x, cross(n, x), n).toVar();
        this.wv = wv.mul(this.frame).toVar();
        super.start(builder);
    }
    saturated(reflectance) {
        return mix(vec3(luminance(reflectance)), reflectance, materialReference('saturation', 'float'));
    }
    coloured(reflectance) {
        return this.saturated(reflectance).max(0).mul(diffuseColor.rgb);
    }
    direct({ lightDirection, lightColor, reflectedLight }) {
        const wl = lightDirection.mul(this.frame).toVar();
        reflectedLight.directDiffuse.addAssign(this.coloured(this.nodes.brdf(wl, this.wv)).mul(wl.z.max(0)).mul(lightColor));
    }
    // A rectangular light emits to one side only.
    directRectArea({ lightColor, lightPosition, halfWidth, halfHeight, reflectedLight }) {
        const middle = lightPosition.sub(positionView), isLit = cross(halfWidth, halfHeight).dot(middle).greaterThanEqual(0);
        const corner = (x, y) => middle.add(halfWidth.mul(x)).add(halfHeight.mul(y)).mul(this.frame);
        const value = this.nodes.area(this.wv, corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1));
        reflectedLight.directDiffuse.addAssign(isLit.select(this.coloured(value).mul(lightColor), vec3(0)));
    }
    indirect({ context }) {
        const { ambientOcclusion, irradiance, reflectedLight } = context;
        reflectedLight.indirectDiffuse.addAssign(this.coloured(this.nodes.albedo(this.wv.z)).mul(irradiance).div(Math.PI));
        if (this.environment) reflectedLight.indirectDiffuse.addAssign(this.reflectedEnvironment());
        reflectedLight.indirectDiffuse.mulAssign(ambientOcclusion);
    }
    reflectedEnvironment() {
        const view = this.nodes.view(this.wv).toVar();
        let sum = vec3(0);
        for (let k = 0; k < LOBES; ++k) {
            const shape = this.nodes.shape(int(k), view).toVar(), axis = this.frame.mul(shape.xyz).transformDirection(cameraViewMatrix);
            const radiance = this.environment.context({ getUV: () => axis, getTextureLevel: () => lookedUp(shape.w) }).isolate();
            sum = sum.add(this.saturated(this.nodes.weight(int(k), view)).mul(radiance));
        }
        return sum.max(0).mul(materialEnvIntensity).mul(diffuseColor.rgb);
    }
}

// Hands the environment to the lighting instead of looking it up about the mirror direction.
class MeasuredEnvironment extends EnvironmentNode {
    setup({ context, material }) {
        const { envNode } = this, texture = envNode.isTextureNode ? envNode.value : envNode.isMaterialReferenceNode && material[envNode.property];
        context.lightingModel.environment = texture ? pmremTexture(texture) : envNode;
    }
}

// A MeshStandardNodeMaterial with a measured reflectance under every light of three: environments (of the scene or its own),
// area lights, ambient light and light probes too. Shadows, fog, occlusion, transparency, normal and bump maps are three's.
// Colours and colour maps multiply the reflectance, and `saturation` multiplies its distance from grey. Roughness and
// metalness are not used.
class MeasuredMaterial extends MeshStandardNodeMaterial {
    constructor(nodes, { saturation = 1, ...parameters } = {}) {
        super();
        Object.defineProperty(this, 'nodes', { value: nodes });
        this.saturation = saturation;
        this.setValues(parameters);
    }
    // With the user's data it is copied, saved and loaded.
    get saturation() {
        return this.userData.saturation ?? 1;
    }
    set saturation(value) {
        this.userData.saturation = value;
    }
    setupEnvironment(builder) {
        const environment = super.setupEnvironment(builder);
        return environment && new MeasuredEnvironment(environment.envNode);
    }
    setupLightingModel() {
        return new MeasuredLighting(this.nodes);
    }
}
