// Types of the module map.js that `srbf export map.srbf --to three -o map.js` writes for a map of texels. Copy it beside the module.
import { MeshStandardMaterial, MeshStandardMaterialParameters, Texture } from 'three';
interface Mapped extends MeshStandardMaterialParameters { coefficients?: Texture | null; saturation?: number }
export class MapMaterial extends MeshStandardMaterial {
    constructor(parameters?: Mapped);
    coefficients: Texture | null;
    saturation: number;
}
export function loadCoefficients(url?: string | URL): Promise<Texture>;
