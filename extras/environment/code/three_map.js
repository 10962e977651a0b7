
// A map's coefficients as a texture, from its KTX 2 file with all levels of the file. Row 0 of the map is at v = 0.
// They are multiplied by `userData.scales`, R, G, B of each lobe, unless that is undefined. Of a file with ASTC blocks the
// levels from `userData.firstCoarse` on are in `userData.coarse`, in bytes, because blocks of coarse levels are seen.
export async function loadCoefficients(url = new URL('FILE', import.meta.url)) {
    const response = await fetch(url);
    if (!response.ok) throw new Error(`${url}: ${response.status}`);
    const bytes = await response.arrayBuffer(), numbers = new DataView(bytes), number = (at) => numbers.getUint32(at, true);
    // R, G, B, A in 16-bit floats, or in 8 bits coded as sRGB, or these in ASTC blocks of 4 x 4 texels.
    const inBlocks = number(12) === 158, ofBytes = inBlocks || number(12) === 43;
    const width = number(20), height = number(24), layers = number(32);
    if (number(0) !== 0x58544bab || !(ofBytes || number(12) === 97) || layers !== LOBES || number(44) !== 0)
        throw new Error(`${url}: expected LOBES layers of 16-bit floats, sRGB or ASTC`);
    const Numbers = ofBytes ? Uint8Array : Uint16Array;
    const levels = Array.from({ length: number(40) }, (_, k) => ({
        data: new Numbers(bytes, number(80 + 24 * k), number(88 + 24 * k) / Numbers.BYTES_PER_ELEMENT),
        width: Math.max(width >> k, 1),
        height: Math.max(height >> k, 1),
    }));
    // An array with its own levels can only be uploaded as a "compressed" one, which accepts this format too.
    const arrayOf = (levels, format) => {
        const { width, height } = levels[0], type = ofBytes ? UnsignedByteType : HalfFloatType;
        const texture = new CompressedArrayTexture(levels, width, height, layers, format, type);
        if (ofBytes) texture.colorSpace = SRGBColorSpace;
        texture.needsUpdate = true;
        return texture;
    };
    const scales = metadataIn(numbers, 'srbf.scale'), coarse = metadataIn(numbers, 'srbf.coarse');
    const first = coarse?.getUint32(0, true) ?? levels.length;
    const texture = arrayOf(levels.slice(0, first), inBlocks ? RGBA_ASTC_4x4_Format : RGBAFormat);
    if (scales) texture.userData.scales = Array.from({ length: 3 * LOBES }, (_, i) => scales.getFloat32(4 * i, true));
    if (coarse) {
        let at = coarse.byteOffset + 4;
        const inBytes = levels.slice(first).map(({ width, height }) => {
            const data = new Uint8Array(bytes, at, 4 * width * height * layers);
            at += data.length;
            return { data, width, height };
        });
        Object.assign(texture.userData, { firstCoarse: first, coarse: arrayOf(inBytes, RGBAFormat) });
        texture.addEventListener('dispose', () => texture.userData.coarse.dispose());
    }
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
        shader.uniforms.measured_first_coarse = { get value() { return material.coefficients?.userData.firstCoarse ?? 0; } };
        shader.uniforms.measured_coarse = {
            get value() {
                const { coefficients } = material, coarse = coefficients?.userData.coarse;
                if (!coarse) return coefficients;
                for (const of of ['wrapS', 'wrapT', 'anisotropy']) coarse[of] = coefficients[of];
                return coarse;
            },
        };
        const ones = new Array(3 * LOBES).fill(1);
        shader.uniforms.measured_scales = { get value() { return material.coefficients?.userData.scales ?? ones; } };
        shader.fragmentShader = after(shader.fragmentShader, '#include <lights_physical_fragment>', `
            measured_dx = dFdx(measured_uv), measured_dy = dFdy(measured_uv);
            vec2 measured_size = vec2(textureSize(measured_coefficients, 0).xy);
            vec2 measured_x = measured_dx * measured_size, measured_y = measured_dy * measured_size;
            float measured_level = 0.5 * log2(max(max(dot(measured_x, measured_x), dot(measured_y, measured_y)), 1.0));
            measured_far = measured_first_coarse > 0.0 ? clamp(measured_level - measured_first_coarse + 1.0, 0.0, 1.0) : 0.0;
            measured_texel = ${this.reflectance}_coefficients(measured_uv.x, measured_uv.y);`);
    }
}
