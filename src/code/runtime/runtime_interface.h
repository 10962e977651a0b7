// srbf_runtime.h: loads a model file of srbf (.srbf) and evaluates it, in C99 and C++. It needs <math.h> and
// <string.h>, and on x86 <immintrin.h>, allocates nothing, reads no file, and has no variables. Printed by srbf; the
// text is under the MIT License.
//
// One source file of the program defines SRBF_RUNTIME_IMPLEMENTATION before it includes this header. Or each file that
// includes it defines SRBF_RUNTIME_STATIC, and has functions of its own. For a linker, names have the version, so that
// two plugins with two versions in one process do not call each other's functions: srbf_value is
// srbf_v@PROJECT_VERSION_MAJOR@_@PROJECT_VERSION_MINOR@_value.
//
// Directions are unit vectors (x, y, z) in the local frame, whose z is the shading normal; wl points to the light, wv
// to the viewer. Lengths are not checked. Colours are R, G, B in linear sRGB.
#ifndef SRBF_RUNTIME_H
#define SRBF_RUNTIME_H

#include <string.h>

// clang-format off
#define SRBF_VERSIONED(name) srbf_v@PROJECT_VERSION_MAJOR@_@PROJECT_VERSION_MINOR@_##name
// clang-format on
#define srbf_memory_needed SRBF_VERSIONED(memory_needed)
#define srbf_open SRBF_VERSIONED(open)
#define srbf_prepare SRBF_VERSIONED(prepare)
#define srbf_is_two_sided SRBF_VERSIONED(is_two_sided)
#define srbf_value SRBF_VERSIONED(value)
#define srbf_values SRBF_VERSIONED(values)
#define srbf_sample SRBF_VERSIONED(sample)
#define srbf_pdf SRBF_VERSIONED(pdf)
#define srbf_value_pdf SRBF_VERSIONED(value_pdf)
#define srbf_albedo SRBF_VERSIONED(albedo)
#if defined SRBF_RUNTIME_STATIC && defined __GNUC__
#define SRBF_API static __attribute__((unused))
#elif defined SRBF_RUNTIME_STATIC
#define SRBF_API static
#else
#define SRBF_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

typedef enum srbf_error {
    SRBF_OK,
    SRBF_NO_MODEL,       // the bytes do not begin as a model file does, or end within its header
    SRBF_BAD_HEADER,     // a malformed header, or tensors that do not fill the file
    SRBF_OTHER_VERSION,  // a file of another version
    SRBF_OTHER_KIND,     // a kind of model that is not known here, or a file of several models
    SRBF_BAD_METADATA,   // a word that is missing, or is none of the format's
    SRBF_BAD_TENSOR,     // a tensor that is missing, of another shape, or unknown
    SRBF_BAD_NUMBER,     // a number out of its range
    SRBF_TOO_LITTLE_MEMORY
} srbf_error;

typedef struct srbf_brdf srbf_brdf;

// The memory that srbf_open needs for this file, about 150 kB and 16 bytes for each byte of a file at most; 0 if the
// file cannot be opened.
SRBF_API size_t srbf_memory_needed(const void* bytes, size_t size);

// Reads a model file in the caller's memory, of any alignment; *brdf lies there. The bytes are not needed afterwards.
// In case of an error, *offset (unless offset is null) is where in the file it is.
SRBF_API srbf_error srbf_open(const void* bytes, size_t size, void* memory, size_t capacity, srbf_brdf** brdf,
                              size_t* offset);

// Computes the densities that samples are drawn from, and the directional albedos: about 0.2 s for each side
// of a surface. Before it, samples are drawn by the cosine, and albedos are 0. Afterwards, several threads may use a
// model.
SRBF_API void srbf_prepare(srbf_brdf* brdf);

// 1 for a two-sided surface, for which z < 0 is the back. Other models are 0 where a z is not above 0.
SRBF_API int srbf_is_two_sided(const srbf_brdf* brdf);

// f(wl, wv) [1/sr], without the cosine. Finite and at least 0. It is 0 if a direction lies below the horizon or in the
// surface (z is 0 or subnormal), or has a component that is not finite or at least 2^50; of a two-sided surface also
// without its beams.
SRBF_API void srbf_value(const srbf_brdf* brdf, const float wl[3], const float wv[3], float rgb[3]);
// Evaluates `count` pairs; each direction and colour is three floats of the arrays.
SRBF_API void srbf_values(const srbf_brdf* brdf, size_t count, const float* wl, const float* wv, float* rgb);

typedef struct srbf_light {
    float wl[3];      // the direction to the light, if pdf > 0 or is_beam
    float weight[3];  // f |cos(theta_l)| / pdf, or of a beam its share over the chance that it is drawn
    float pdf;        // [1/sr]; 0 for a beam, and where the sample has no direction, which then counts with weight 0
    int is_beam;      // light that a two-sided surface does not scatter
} srbf_light;

// Samples a direction to the light from three independent numbers, uniform in [0, 1): a point, and the selector of a
// lobe.
SRBF_API void srbf_sample(const srbf_brdf* brdf, const float wv[3], const float u[3], srbf_light* light);
// The density of srbf_sample [1/sr], 0 where srbf_value is 0 by its directions.
SRBF_API float srbf_pdf(const srbf_brdf* brdf, const float wl[3], const float wv[3]);
// Both.
SRBF_API float srbf_value_pdf(const srbf_brdf* brdf, const float wl[3], const float wv[3], float rgb[3]);

// The share of the light that is reflected to a view at this cosine to the normal, as the mean over four azimuths:
// ∫ f(wl, wv) cos(theta_l) dwl, estimated by samples. It is within about 3 %, and rough where it depends on the
// azimuth. Cosines below 0 are at the back.
SRBF_API void srbf_albedo(const srbf_brdf* brdf, float cosine, float rgb[3]);

#ifdef __cplusplus
}
#endif

#endif

#if (defined SRBF_RUNTIME_IMPLEMENTATION || defined SRBF_RUNTIME_STATIC) && !defined SRBF_RUNTIME_IMPLEMENTED
#define SRBF_RUNTIME_IMPLEMENTED
