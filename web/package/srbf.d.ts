/** Options of a fit. Omitted options have the defaults of `srbf fit`. */
export interface FitOptions {
  /** The kind of model, by its name in `srbf fit --model`. */
  model?: string;
  lobes?: number;
  variates?: number;
  /** Tables are fitted by "reciprocal". */
  form?: "gaussian" | "extended" | "reciprocal";
  /** Fits the table as it is, by a form that is not reciprocal. */
  asMeasured?: boolean;
  /** The largest directional albedo of each channel. */
  albedoLimit?: number;
  objective?: "appearance" | "cosine" | "raw" | "log" | "cube-root" | "relative";
  seed?: number;
  /** Largest angle from the normal [degrees]. */
  maxTheta?: number;
  /** Chooses the size: the fewest lobes with at most this visible error. */
  targetDeltaE?: number;
  /** Called during the fit with the current stage and the completed fraction; returning false cancels. */
  progress?: (stage: string, fraction: number) => boolean | void;
}

/** Errors of pictures of a sphere, compared with the measurement: means over eight lightings. */
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
  /** Absent for reflection and transmission. For samples it is the worst of three errors: of pictures, of cross-validation and at the samples. */
  seen?: Seen;
  /** A sentence that sums up the errors. */
  headline?: string;
  /** Errors against the measurement after smoothing, if it is noisy. */
  smoothed?: Seen;
}

export type Language = {{languages}};

/** A measurement or a model. */
export interface Brdf {
  /** f [1/sr] at pairs of unit vectors in the local frame, z along the normal: x, y, z of each in `wl` and `wv`, and R, G, B of each in the result. */
  evaluate(wl: ArrayLike<number>, wv: ArrayLike<number>): Float32Array;
  /** The bytes of a table, for a file with this name: .binary (MERL), .bsdf (RGL), .mbsdf (MDL) or .csv. */
  table(name: string): Uint8Array;
  /** A script in Python that makes a material for Blender (Cycles). It takes about 12 seconds. Throws for scattered samples, and for reflection and transmission. */
  blender(): string;
  /** Frees the memory of the BRDF. */
  close(): void;
}

export interface Model extends Brdf {
  /** The report of the fit; absent for a model that was opened. */
  report?: Report;
  /** The bytes of a model file (.srbf). */
  file(): Uint8Array;
  /** Shading code with NAME_brdf(wl, wv), where NAME is from the file's name; `sampling` adds NAME_sample and NAME_pdf, `environment` NAME_environment. */
  code(language: Language, options?: { sampling?: boolean; environment?: boolean }): string;
}

/** Fits a model to the bytes of a measurement with this name. Throws an Error of one line: file, offset, what, expected, found. */
export function fit(bytes: Uint8Array, options?: FitOptions & { name?: string }): Promise<Model>;
/** Reads a measurement, or a model. */
export function open(bytes: Uint8Array, name?: string): Promise<Brdf | Model>;
