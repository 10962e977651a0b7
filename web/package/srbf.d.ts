/** Options of a fit; what is left out is the default of `srbf fit`. */
export interface FitOptions {
  /** pm: a sum of products of lobes; ggx: Lambert and one or two lobes of GGX. */
  model?: "pm" | "ggx";
  lobes?: number;
  variates?: number;
  form?: "gaussian" | "horizon" | "extended";
  objective?: "appearance" | "cosine" | "raw" | "log" | "cube-root" | "relative";
  seed?: number;
  /** Largest angle from the normal [degrees]. */
  maxTheta?: number;
  /** Chooses the size: the smallest model within this visible error, or the best within so many bytes. */
  targetDeltaE?: number;
  budget?: number;
  /** Called while it fits, with what is done and the completed share; false cancels. */
  progress?: (stage: string, fraction: number) => boolean | void;
}

/** How different pictures of a sphere look beside the measurement's: means over eight lightings. */
export interface Seen {
  /** ΔE_ITP; 1 is just noticeable. */
  deltaE: number;
  worst: number;
  flip: number;
  verdict: string;
}

export interface Report {
  format: string;
  sourceBytes: number;
  bytes: number;
  seconds: number;
  twoSided: boolean;
  /** Of a measurement of one side. */
  seen?: Seen;
  /** The same of a noisy measurement that is smoothed. */
  smoothed?: Seen;
}

export type Language = "glsl" | "hlsl" | "wgsl" | "msl" | "c" | "three";

/** A measurement or a model. */
export interface Brdf {
  /** f [1/sr] at pairs of unit vectors in the local frame, z along the normal: x, y, z one after the other; red, green and blue of each. */
  evaluate(wl: ArrayLike<number>, wv: ArrayLike<number>): Float32Array;
  /** The bytes of a table for a file of that name: .binary (MERL), .bsdf (RGL), .mbsdf (MDL) or .csv. */
  table(name: string): Uint8Array;
  /** Frees its memory. */
  close(): void;
}

export interface Model extends Brdf {
  /** Only of a model that was fitted. */
  report?: Report;
  /** The bytes of a model file (.srbf). */
  file(): Uint8Array;
  /** Shading code with NAME_brdf(wl, wv), NAME from the file's name; with `sampling` NAME_sample and NAME_pdf too. */
  code(language: Language, options?: { sampling?: boolean }): string;
}

/** Fits a model to the bytes of a measurement of that name. Throws an Error of one line: file, place, what, expected, found. */
export function fit(bytes: Uint8Array, options?: FitOptions & { name?: string }): Promise<Model>;
/** Reads a measurement, or a model. */
export function open(bytes: Uint8Array, name?: string): Promise<Brdf | Model>;
