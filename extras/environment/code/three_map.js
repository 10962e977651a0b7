
// A map's coefficients as a texture, from its KTX 2 file with all levels of the file. Row 0 of the map is at v = 0.
export async function loadCoefficients(url = new URL('FILE', import.meta.url)) {
    const response = await fetch(url);
    if (!response.ok) throw new Error(`${url}: ${response.status}`);
    const bytes = await response.arrayBuffer(), numbers = new DataView(bytes), number = (at) => numbers.getUint32(at, true);
    const format = 97, width = number(20), height = number(24), layers = number(32);  // R, G, B, A in 16-bit floats
    if (number(0) !== 0x58544bab || number(12) !== format || layers !== LOBES || number(44) !== 0)
        throw new Error(`${url}: expected LOBES layers of uncompressed 16-bit floats`);
    const levels = Array.from({ length: number(40) }, (_, k) => ({
        data: new Uint16Array(bytes, number(80 + 24 * k), number(88 + 24 * k) / 2),
        width: Math.max(width >> k, 1),
        height: Math.max(height >> k, 1),
    }));
    // An array with its own levels can only be uploaded as a "compressed" one, which accepts this format too.
    const texture = new CompressedArrayTexture(levels, width, height, layers, RGBAFormat, HalfFloatType);
    texture.needsUpdate = true;
    return texture;
}

// A MeasuredMaterial whose reflectance varies over the surface, like `coefficients` at the mesh's uv. They are a
// texture with its repeat, offset, rotation, wrapping and anisotropy. The material is black until they are set.
class MeasuredMap extends MeasuredMaterial {
    constructor(reflectance, { coefficients = null, ...parameters } = {}) {
        super(reflectance, parameters, { texel: ', measured_texel' });
        this.coefficients = coefficients;
    }
    copy(source) {
        super.copy(source);
        this.coefficients = source.coefficients;
        return this;
    }
    onBeforeCompile(shader) {
        super.onBeforeCompile(shader);
        const material = this;
        addUv(shader, () => material.coefficients);
        shader.uniforms.measured_coefficients = { get value() { return material.coefficients; } };
        shader.fragmentShader = after(shader.fragmentShader, '#include <lights_physical_fragment>', `
            measured_texel = ${this.reflectance}_coefficients(measured_uv.x, measured_uv.y);`);
    }
}
