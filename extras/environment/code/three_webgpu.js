// For three.js and its WebGPURenderer; tried with release 185.
import { CubeUVReflectionMapping, EnvironmentNode, HalfFloatType, LightingModel, LinearMipmapLinearFilter, MeshStandardNodeMaterial,
         NoBlending, NodeMaterial, QuadMesh, RendererUtils, RenderTarget, TextureNode } from 'three/webgpu';
import { cameraViewMatrix, cross, cubeTexture, diffuseColor, equirectUV, int, luminance, mat3, materialEnvIntensity, materialEnvRotation,
         materialReference, mix, normalView, pmremTexture, positionView, positionViewDirection, sampler, screenCoordinate, texture, vec2,
         vec3, vec4, wgsl, wgslFn } from 'three/tsl';

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

// Octahedral maps of an environment, y upwards. An atlas holds six levels, each in a border of one texel: level k is filtered for the
// roughness r = (k / 5)^2 as engines filter for GGX seen along the normal.
const octahedral = wgsl(/* wgsl */ `
const srbf_side = array<f32, 6>(1024.0, 512.0, 256.0, 64.0, 64.0, 32.0);
const srbf_corner = array<vec2f, 6>(vec2f(1.0), vec2f(1027.0, 1.0), vec2f(1027.0, 515.0), vec2f(1027.0, 773.0), vec2f(1027.0, 839.0),
                                    vec2f(1027.0, 905.0));
const srbf_atlas = vec2f(1540.0, 1026.0);
fn srbf_signs(p: vec2f) -> vec2f { return select(vec2f(-1.0), vec2f(1.0), p >= vec2f(0.0)); }
fn srbf_place(w: vec3f) -> vec2f {
    let p = w.xz / (abs(w.x) + abs(w.y) + abs(w.z));
    return 0.5 + 0.5 * select((1.0 - abs(p.yx)) * srbf_signs(p), p, w.y >= 0.0);
}
// The point of the octahedron |x| + |y| + |z| = 1 for a place in the unit square or, for the border, just beyond it.
fn srbf_point(place: vec2f) -> vec3f {
    var p = 2.0 * place - 1.0;
    if (abs(p.x) > 1.0) { p = vec2f(sign(p.x) * (2.0 - abs(p.x)), -p.y); }
    if (abs(p.y) > 1.0) { p = vec2f(-p.x, sign(p.y) * (2.0 - abs(p.y))); }
    let y = 1.0 - abs(p.x) - abs(p.y);
    let q = p - srbf_signs(p) * max(-y, 0.0);
    return vec3f(q.x, y, q.y);
}
`);
const octahedralDirection = wgslFn('fn srbf_direction(place: vec2f) -> vec3f { return normalize(srbf_point(place)); }', [octahedral]);
// A texel of the atlas from an octahedral map with mip levels. The lobes of levels 0 and 1 are narrower than a texel. That of level 2 is
// sampled, and each sample looks up the level whose texels have the solid angle in which one sample is expected. Those of the others are
// sums over 64 x 64 texels.
const filtered = wgslFn(/* wgsl */ `fn srbf_filtered(map: texture_2d<f32>, linear: sampler, pixel: vec2f) -> vec4f {
    var level = select(1, 0, pixel.x < 1026.0);
    while (level > 0 && level < 5 && pixel.y >= srbf_corner[level].y + srbf_side[level] + 1.0) { level++; }
    let n = normalize(srbf_point((pixel - srbf_corner[level]) / srbf_side[level]));
    if (level < 2) { return textureSampleLevel(map, linear, srbf_place(n), f32(level)); }
    let alpha2 = pow(f32(level) / 5.0, 8.0);
    var sum = vec4f(0.0);
    if (level > 2) {
        for (var i = 0; i < 4096; i++) {
            let texel = vec2i(i % 64, i / 64);
            let q = srbf_point((vec2f(texel) + 0.5) / 64.0);
            let inverse = inverseSqrt(dot(q, q));
            let z = inverse * dot(q, n);
            let solid_angle = inverse * inverse * inverse;  // times 1024
            let slope = 1.0 - 0.5 * (1.0 + z) * (1.0 - alpha2);
            sum += max(z, 0.0) * solid_angle / (slope * slope) * vec4f(textureLoad(map, texel, 4).rgb, 1.0);
        }
        return vec4f(sum.rgb / sum.w, 1.0);
    }
    let x = normalize(select(cross(vec3f(0.0, 1.0, 0.0), n), cross(vec3f(1.0, 0.0, 0.0), n), abs(n.y) > 0.9));
    let y = cross(n, x);
    for (var i = 0u; i < SAMPLESu; i++) {
        let u = (f32(i) + 0.5) / SAMPLES.0;
        let phi = 6.2831853 * f32(reverseBits(i)) / 4294967296.0;
        let sine2 = u * alpha2 / (1.0 - u + u * alpha2);  // of the half vector
        let z = 1.0 - 2.0 * sine2;
        if (z <= 0.0) { continue; }
        let density = alpha2 / (12.566371 * pow(alpha2 + sine2 * (1.0 - alpha2), 2.0));
        let mip = 0.5 * log2(max(1048576.0 / (25.132741 * SAMPLES.0 * density), 1.0));
        let radius = 2.0 * sqrt(sine2 * (1.0 - sine2));
        let w = radius * cos(phi) * x + radius * sin(phi) * y + z * n;
        sum += z * vec4f(textureSampleLevel(map, linear, srbf_place(w), mip).rgb, 1.0);
    }
    return vec4f(sum.rgb / sum.w, 1.0);
}`.replaceAll('SAMPLES', '256'), [octahedral]);
const lookedUp = wgslFn(/* wgsl */ `fn srbf_looked_up(map: texture_2d<f32>, linear: sampler, w: vec3f, roughness: f32) -> vec3f {
    let position = 5.0 * sqrt(roughness);
    let level = i32(position);
    let place = srbf_place(w);
    let fine = textureSampleLevel(map, linear, (srbf_corner[level] + place * srbf_side[level]) / srbf_atlas, 0.0).rgb;
    if (position == f32(level)) { return fine; }
    let coarse = textureSampleLevel(map, linear, (srbf_corner[level + 1] + place * srbf_side[level + 1]) / srbf_atlas, 0.0).rgb;
    return mix(fine, coarse, position - f32(level));
}`, [octahedral]);

const target = (width, height, mipmaps = {}) => new RenderTarget(width, height, { type: HalfFloatType, depthBuffer: false, ...mipmaps });
// A pass over all pixels of a target.
function drawn(renderer, into, node) {
    const material = Object.assign(new NodeMaterial(), { fragmentNode: node, blending: NoBlending, depthTest: false, depthWrite: false });
    renderer.setRenderTarget(into);
    new QuadMesh(material).render(renderer);
    material.dispose();
}
const isLoaded = ({ image, isCubeTexture, isRenderTargetTexture }) =>
    isRenderTargetTexture || (isCubeTexture ? image.length === 6 && image.every(Boolean) : image?.height > 0);
// The atlas of an environment, an equirectangular or a cube texture of three. It is filtered before the first frame that needs it, and again after a
// change.
class FilteredEnvironment extends TextureNode {
    static get type() {
        return 'FilteredEnvironment';
    }
    constructor(source) {
        const atlas = target(1540, 1026);
        super(atlas.texture);
        Object.assign(this, { source, atlas, version: -1, updateBeforeType: 'render' });
        source.addEventListener('dispose', () => atlas.dispose());
    }
    radiance(axis, roughness) {
        return lookedUp({ map: this, linear: sampler(this), w: materialEnvRotation.mul(axis), roughness });
    }
    updateBefore({ renderer }) {
        const { source, atlas } = this;
        if (this.version === source.version || !isLoaded(source)) return;
        this.version = source.version;
        const state = RendererUtils.resetRendererState(renderer, {}), side = 1024;
        const map = target(side, side, { generateMipmaps: true, minFilter: LinearMipmapLinearFilter });
        // Points along a texel, so that the source's texels are not missed.
        const width = source.isCubeTexture ? 4 * (source.image[0]?.width ?? source.image.width) : source.image.width;
        const points = Math.min(Math.ceil(width / 2048), 4), offset = (i) => (i + 0.5) / points - 0.5;
        let sum = vec3(0);
        for (let i = 0; i < points ** 2; ++i) {
            const w = octahedralDirection(screenCoordinate.add(vec2(offset(i % points), offset(Math.floor(i / points)))).div(side));
            sum = sum.add((source.isCubeTexture ? cubeTexture(source, w, 0) : texture(source, equirectUV(w), 0)).rgb.min(65504));
        }
        drawn(renderer, map, vec4(sum.div(points ** 2), 1));
        const read = texture(map.texture);
        drawn(renderer, atlas, filtered({ map: read, linear: sampler(read), pixel: screenCoordinate }));
        RendererUtils.restoreRendererState(renderer, state);
        map.dispose();
    }
}
const environments = new WeakMap();  // of each renderer, by their textures
function environmentOf(renderer, source) {
    if (!environments.has(renderer)) environments.set(renderer, new WeakMap());
    const known = environments.get(renderer);
    if (!known.has(source)) known.set(source, new FilteredEnvironment(source));
    return known.get(source);
}
// A node of three's own, such as a map that its PMREMGenerator made. Release 185 filters by a chain of convolutions, whose product is another kernel:
// this is the roughness of the chain that is as blurred, fitted to the Legendre spectra of chains of 9 to 11 levels within 0.03.
const byThree = (node) => ({
    radiance: (axis, r) => node.context({ getUV: () => axis, getTextureLevel: () => r.mul(r.mul(-0.15).sub(r.pow(3).mul(0.3)).add(1.4)) }).isolate(),
});

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
            sum = sum.add(this.saturated(this.nodes.weight(int(k), view)).mul(this.environment.radiance(axis, shape.w)));
        }
        return sum.max(0).mul(materialEnvIntensity).mul(diffuseColor.rgb);
    }
}

// Hands the environment to the lighting instead of looking it up about the mirror direction.
class MeasuredEnvironment extends EnvironmentNode {
    setup({ context, material, renderer }) {
        const { envNode } = this, source = envNode.isMaterialReferenceNode ? material[envNode.property] : envNode.value;
        const isFiltered = source?.isPMREMTexture || source?.mapping === CubeUVReflectionMapping;
        context.lightingModel.environment = source?.isTexture && !isFiltered ? environmentOf(renderer, source)
            : byThree(source?.isTexture ? pmremTexture(source) : envNode);
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
