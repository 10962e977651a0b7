// For three.js, release 187, and its WebGLRenderer.
import { MeshLambertMaterial } from 'three';

const functions = /* glsl */ `
FUNCTIONS`;

// What three's loop over its lights calls instead of Lambert's formula.
const reflection = (name) => /* glsl */ `
${functions}
// The frame about the normal, made visible to the viewer: x along the tangent if the geometry has tangents (define
// USE_TANGENT), otherwise along the circle of latitude about y.
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
                       const in LambertMaterial material, inout ReflectedLight reflectedLight) {
    mat3 frame = ${name}_frame(geometryNormal, geometryViewDir);
    vec3 wl = directLight.direction * frame;
    vec3 f = ${name}_brdf(wl, geometryViewDir * frame);
    reflectedLight.directDiffuse += max(wl.z, 0.0) * f * material.diffuseColor * directLight.color;
}
void RE_IndirectDiffuse_${name}(const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal,
                                const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal,
                                const in LambertMaterial material, inout ReflectedLight reflectedLight) {
    vec3 reflected = ${name}_albedo(saturate(dot(geometryNormal, geometryViewDir)));
    reflectedLight.indirectDiffuse += irradiance * RECIPROCAL_PI * reflected * material.diffuseColor;
}
#undef RE_Direct
#undef RE_IndirectDiffuse
#define RE_Direct RE_Direct_${name}
#define RE_IndirectDiffuse RE_IndirectDiffuse_${name}
`;

// A MeshLambertMaterial with a measured reflectance. Skinning, instances, shadows, fog, normal and bump maps are
// three's; colours, colour maps and vertex colours multiply the reflectance. Ambient light and light probes are
// reflected by its directional albedo; environment maps and area lights have no effect.
class MeasuredMaterial extends MeshLambertMaterial {
    constructor(reflectance, parameters) {
        super(parameters);
        Object.defineProperty(this, 'reflectance', { value: reflectance });
    }
    onBeforeCompile(shader) {
        const lights = '#include <lights_lambert_pars_fragment>';
        shader.fragmentShader = shader.fragmentShader.replace(lights, () => lights + reflection(this.reflectance));
    }
    customProgramCacheKey() {
        return this.reflectance + functions;
    }
}

