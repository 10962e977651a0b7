// From a point of a surface to the colour of a pixel, in the common subset of GLSL and C++ like kernel.glsl. The
// host must also define pow, normalize, cross and dot.

// ---- To the screen -----------------------------------------------------------------------------------------------

#define SRBF_KNEE 0.76
#define SRBF_WHITENING 0.15

// Tone mapping of x = exposure * radiance >= 0 to [0,1]^3, with m its largest channel:
//   x                          if m <= k,
//   (1-g) x m'/m + g m'        otherwise, m' = 1 - (1-k)^2/(m + 1 - 2k), g = 1 - 1/(1 + s(m - m')),
// k = 0.76, s = 0.15: the Khronos PBR Neutral tone mapper (2024) without its toe.
SRBF_FN Vec3 tone_mapped(Vec3 x) {
    Real knee = Real(SRBF_KNEE);
    Real peak = max(x.x, max(x.y, x.z));
    Real beyond = max(peak, knee);
    Real new_peak = Real(1.0) - (Real(1.0) - knee) * (Real(1.0) - knee) / (beyond + Real(1.0) - Real(2.0) * knee);
    Real whitened = Real(1.0) - Real(1.0) / (Real(1.0) + Real(SRBF_WHITENING) * (beyond - new_peak));
    Real white = whitened * new_peak;
    Bool linear = peak <= knee;
    return Vec3(select(linear, x.x, (Real(1.0) - whitened) * (x.x / beyond) * new_peak + white),
                select(linear, x.y, (Real(1.0) - whitened) * (x.y / beyond) * new_peak + white),
                select(linear, x.z, (Real(1.0) - whitened) * (x.z / beyond) * new_peak + white));
}

// The transfer function of sRGB (IEC 61966-2-1) on [0,1]: 12.92 x if x <= 0.0031308, otherwise 1.055 x^(1/2.4) - 0.055.
SRBF_FN Real srgb_transfer(Real x) {
    return select(x <= Real(0.0031308), Real(12.92) * x, Real(1.055) * pow(x, Real(1.0 / 2.4)) - Real(0.055));
}

// ---- The surface -------------------------------------------------------------------------------------------------

// The least cosine between a shading normal and the direction to the viewer: 89.4 degrees.
#define SRBF_LEAST_COSINE 0.01

// The unit vector of an interpolated normal of any length except 0, made visible to the viewer at wv. A normal that
// points away from the viewer, as happens along the silhouette of a mesh, is first moved towards wv until the
// cosine is SRBF_LEAST_COSINE.
SRBF_FN Vec3 visible_normal(Vec3 interpolated, Vec3 wv) {
    Vec3 n = normalize(interpolated);
    return normalize(n + max(Real(SRBF_LEAST_COSINE) - dot(n, wv), Real(0.0)) * wv);
}

struct SurfaceFrame {
    Vec3 tangent;
    Vec3 bitangent;
    Vec3 normal;
};

// The frame around a unit normal n: t = (n_z, 0, -n_x) / sqrt(n_x^2 + n_z^2) along the circle of latitude around y,
// n x t, n. At the poles t = (1, 0, 0).
SRBF_FN SurfaceFrame surface_frame_about(Vec3 n) {
    SurfaceFrame frame;
    Real squared = n.x * n.x + n.z * n.z;
    Real reciprocal = inversesqrt(max(squared, Real(1.0e-20)));
    frame.tangent = Vec3(select(squared > Real(1.0e-20), reciprocal * n.z, Real(1.0)), Real(0.0), -reciprocal * n.x);
    frame.bitangent = cross(n, frame.tangent);
    frame.normal = n;
    return frame;
}

// The coordinates of w in the frame.
SRBF_FN Vec3 to_surface(SurfaceFrame frame, Vec3 w) {
    return Vec3(dot(w, frame.tangent), dot(w, frame.bitangent), dot(w, frame.normal));
}
