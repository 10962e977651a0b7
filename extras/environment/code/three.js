// For three.js, release 187, and its WebGLRenderer.
import { DataTexture, FloatType, MeshStandardMaterial, RGBAFormat, REVISION } from 'three';

if (parseInt(REVISION) !== 187)
    console.warn(`three.js ${REVISION}: this material was written for release 187, and may ignore environments in others`);

const functions = /* glsl */ `
FUNCTIONS`;

// Replaces the formulas of three's standard material for each of its lights. `texel` is appended to the arguments
// of the reflectance's functions.
const reflection = (name, texel) => /* glsl */ `
mat3 measured_frame;  // from the frame around the normal to that of the view
// The environment, filtered by three as for GGX. Without an environment, the functions below are not called.
vec3 measured_radiance(vec3 direction, float roughness) {
    #if defined(USE_ENVMAP) && defined(ENVMAP_TYPE_PMREM)
        vec3 w = envMapRotation * transformDirectionByInverseViewMatrix(measured_frame * direction, viewMatrix);
        return textureLod(envMap, w, roughnessToMip(roughness)).rgb * envMapIntensity;
    #else
        return vec3(0.0);
    #endif
}
// The lobes of the views, and albedos. They are in a texture because some drivers index constants slowly.
uniform highp sampler2D measured_lobes;
vec3 measured_light_texel(int i, int view) {
    return texelFetch(measured_lobes, ivec2(i, view), 0).rgb;
}
${functions}
// The frame around the normal, made visible to the viewer. x is along the tangent if the geometry has tangents
// (define USE_TANGENT), otherwise along the circle of latitude around y.
mat3 ${name}_frame(vec3 n, vec3 wv) {
    n = normalize(n + max(0.01 - dot(n, wv), 0.0) * wv);
    #ifdef USE_TANGENT
        vec3 t = vTangent - dot(vTangent, n) * n;
    #else
        vec3 t = cross((viewMatrix * vec4(0.0, 1.0, 0.0, 0.0)).xyz, n);
    #endif
    t = dot(t, t) > 1e-12 ? normalize(t) : normalize(cross(n, (viewMatrix * vec4(0.0, 0.0, 1.0, 0.0)).xyz));
    return mat3(t, cross(n, t), n);
}
void RE_Direct_${name}(const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal,
                       const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal,
                       const in PhysicalMaterial material, inout ReflectedLight reflectedLight) {
    mat3 frame = ${name}_frame(geometryNormal, geometryViewDir);
    vec3 wl = directLight.direction * frame;
    vec3 f = ${name}_brdf(wl, geometryViewDir * frame${texel});
    reflectedLight.directDiffuse += max(wl.z, 0.0) * f * material.diffuseColor * directLight.color;
}
#if NUM_RECT_AREA_LIGHTS > 0
// A rectangular light emits to one side only.
void RE_Direct_RectArea_${name}(const in RectAreaLight rectAreaLight, const in vec3 geometryPosition,
                                const in vec3 geometryNormal, const in vec3 geometryViewDir,
                                const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material,
                                inout ReflectedLight reflectedLight) {
    vec3 middle = rectAreaLight.position - geometryPosition, x = rectAreaLight.halfWidth, y = rectAreaLight.halfHeight;
    if (dot(cross(x, y), middle) < 0.0) return;
    mat3 frame = ${name}_frame(geometryNormal, geometryViewDir);
    vec3 reflected = ${name}_area(geometryViewDir * frame, (middle - x - y) * frame, (middle + x - y) * frame,
                                  (middle + x + y) * frame, (middle - x + y) * frame${texel});
    reflectedLight.directDiffuse += rectAreaLight.color * material.diffuseColor * reflected;
}
#endif
void RE_IndirectDiffuse_${name}(const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal,
                                const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal,
                                const in PhysicalMaterial material, inout ReflectedLight reflectedLight) {
    if (irradiance == vec3(0.0)) return;
    vec3 reflected = ${name}_albedo(saturate(dot(geometryNormal, geometryViewDir))${texel});
    reflectedLight.indirectDiffuse += irradiance * RECIPROCAL_PI * reflected * material.diffuseColor;
}
void RE_IndirectSpecular_${name}(const in vec3 radiance, const in vec3 irradiance, const in vec3 clearcoatRadiance,
                                 const in vec3 geometryPosition, const in vec3 geometryNormal,
                                 const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal,
                                 const in PhysicalMaterial material, inout ReflectedLight reflectedLight) {
    measured_frame = ${name}_frame(geometryNormal, geometryViewDir);
    vec3 reflected = ${name}_environment(geometryViewDir * measured_frame${texel});
    reflectedLight.indirectDiffuse += reflected * material.diffuseColor;
}
#undef RE_Direct
#undef RE_Direct_RectArea
#undef RE_IndirectDiffuse
#undef RE_IndirectSpecular
#define RE_Direct RE_Direct_${name}
#define RE_Direct_RectArea RE_Direct_RectArea_${name}
#define RE_IndirectDiffuse RE_IndirectDiffuse_${name}
#define RE_IndirectSpecular RE_IndirectSpecular_${name}
`;

// The texels of measured_light_texel, one row for each view.
function lobesTexture(numbers) {
    const views = VIEWS, texels = new Float32Array((4 * numbers.length) / 3);
    for (let i = 0, j = 0; i < numbers.length; i += 3, j += 4) texels.set(numbers.slice(i, i + 3), j);
    const texture = new DataTexture(texels, texels.length / (4 * views), views, RGBAFormat, FloatType);
    texture.needsUpdate = true;
    return texture;
}

// A MeshStandardMaterial with a measured reflectance under every light of three: environments (of the scene or its
// own), area lights, ambient light and light probes too. Skinning, instances, shadows, fog, occlusion,
// transparency, normal and bump maps are three's. Colours, colour maps and vertex colours multiply the reflectance.
// Roughness and metalness are not used.
class MeasuredMaterial extends MeshStandardMaterial {
    constructor(reflectance, parameters, { texel = '', lobes = null } = {}) {
        super({ metalness: 0, ...parameters });
        Object.defineProperties(this, { reflectance: { value: reflectance }, texel: { value: texel }, lobes: { value: lobes } });
    }
    onBeforeCompile(shader) {
        shader.uniforms.measured_lobes = { value: this.lobes };
        const lights = '#include <lights_physical_pars_fragment>';
        shader.fragmentShader = shader.fragmentShader.replace(lights, () => lights + reflection(this.reflectance, this.texel));
    }
    customProgramCacheKey() {
        return this.reflectance + functions + this.onBeforeCompile;
    }
    // The JSON of three has no reflectance: loading it yields a MeshStandardMaterial.
    toJSON(meta) {
        console.warn(`${this.constructor.name}: JSON does not keep the reflectance; construct the material after loading`);
        return super.toJSON(meta);
    }
}

