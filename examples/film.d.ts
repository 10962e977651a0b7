// Types of the module film.js that `srbf export film.srbf --to three -o film.js` writes. Copy it beside the module, and put the names
// of your models in place of Film.
import { Material, MeshStandardMaterial, MeshStandardMaterialParameters, Texture } from 'three';
interface Measured extends MeshStandardMaterialParameters { saturation?: number }
export class FilmMaterial extends MeshStandardMaterial {
    constructor(parameters?: Measured);
    saturation: number;
}
interface Blend extends MeshStandardMaterialParameters { mask?: Texture | null; vertexMask?: boolean; shares?: number[] }
export class BlendMaterial extends MeshStandardMaterial {
    constructor(...terms: (Material | Blend)[]);
    mask: Texture | null;
    vertexMask: boolean;
    shares: number[];
}
