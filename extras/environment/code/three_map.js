
// A map's coefficients as a texture, from its KTX 2 file with all levels of the file. Row 0 of the map is at v = 0.
// They are multiplied by `userData.scales`, R, G, B of each lobe, unless that is undefined.
export async function loadCoefficients(url = new URL('FILE', import.meta.url)) {
    const response = await fetch(url);
    if (!response.ok) throw new Error(`${url}: ${response.status}`);
    const bytes = await response.arrayBuffer(), numbers = new DataView(bytes), number = (at) => numbers.getUint32(at, true);
    const ofBytes = number(12) === 43; // R, G, B, A in 8 bits coded as sRGB, otherwise in 16-bit floats
    const width = number(20), height = number(24), layers = number(32);
    if (number(0) !== 0x58544bab || !(ofBytes || number(12) === 97) || layers !== LOBES || number(44) !== 0)
        throw new Error(`${url}: expected LOBES layers of 16-bit floats or sRGB`);
    const Numbers = ofBytes ? Uint8Array : Uint16Array;
    const levels = Array.from({ length: number(40) }, (_, k) => ({
        data: new Numbers(bytes, number(80 + 24 * k), number(88 + 24 * k) / Numbers.BYTES_PER_ELEMENT),
        width: Math.max(width >> k, 1),
        height: Math.max(height >> k, 1),
    }));
    // An array with its own levels can only be uploaded as a "compressed" one, which accepts this format too.
    const texture = new CompressedArrayTexture(levels, width, height, layers, RGBAFormat, ofBytes ? UnsignedByteType : HalfFloatType);
    if (ofBytes) texture.colorSpace = SRGBColorSpace;
    texture.needsUpdate = true;
    const scales = metadataIn(numbers, 'srbf.scale');
    if (scales) texture.userData.scales = Array.from({ length: 3 * LOBES }, (_, i) => scales.getFloat32(4 * i, true));
    return texture;
}
// The value of that name in the metadata of a KTX 2 file, or undefined.
function metadataIn(numbers, name) {
    const end = numbers.getUint32(56, true) + numbers.getUint32(60, true);
    for (let at = numbers.getUint32(56, true); at < end;) {
        const length = numbers.getUint32(at, true), first = at + 4 + name.length + 1;
        const key = String.fromCharCode(...new Uint8Array(numbers.buffer, at + 4, name.length));
        if (key === name) return new DataView(numbers.buffer, first, length - name.length - 1);
        at += 4 * Math.ceil((4 + length) / 4);
    }
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
    addReflectance(shader) {
        super.addReflectance(shader);
        const material = this;
        addUv(shader, () => material.coefficients);
        shader.uniforms.measured_coefficients = { get value() { return material.coefficients; } };
        const ones = new Array(3 * LOBES).fill(1);
        shader.uniforms.measured_scales = { get value() { return material.coefficients?.userData.scales ?? ones; } };
        shader.fragmentShader = after(shader.fragmentShader, '#include <lights_physical_fragment>', `
            measured_texel = ${this.reflectance}_coefficients(measured_uv.x, measured_uv.y);`);
    }
}
