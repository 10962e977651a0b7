// Fitted BRDFs and their file format.
#pragma once
#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "srbf/brdf.h"
#include "srbf/models/bsdf.h"
#include "srbf/models/ggx.h"
#include "srbf/models/openpbr.h"
#include "srbf/models/pm.h"
#include "srbf/models/su.h"
#include "srbf/result.h"

namespace [[gnu::visibility("default")]] srbf {

struct PmRequest;  // fit.h
struct SuRequest;

/// All kinds of models, and the requests for those that are fitted.
using AnyModel = std::variant<PmModel, SuModel, GgxModel, BsdfModel, OpenPbrModel>;
using AnyRequest = std::variant<PmRequest, SuRequest, GgxRequest, OpenPbrRequest>;

/// The content of a model file: a model and its provenance.
struct Model {
    AnyModel model;
    std::map<std::string, std::string> provenance;  ///< source file, options, errors, version
};
/// The kind of a model: "pm", "su", "ggx", "bsdf" or "openpbr", as its file has it, and in words.
std::string_view kind(const Model& model);
std::string_view kind_words(const Model& model);

/// f(wl, wv); of a BSDF on either side, without the beams.
Rgb value(const Model& model, Vec3f wl, Vec3f wv);

/// f[i] = value(model, wl[i], wv[i]), with the widest SIMD instructions of the machine. The spans have the same length.
/// The values of a multivariate model are within 1e-4 of `value` or 1e-6 of the model's peak.
void evaluate(const Model& model, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f);
/// `model` as an `Evaluate`. It keeps a reference to `model`.
Evaluate evaluator(const Model& model);

/// True if f_r depends only on the difference of the azimuths by construction: not with general lobes.
bool is_isotropic(const Model& model);
/// Exchanges light and viewer: f_r(wl, wv) of the result is f_r(wv, wl) of the argument. The provenance of a model of
/// exchanged data has `k_exchanged` as "exchanged".
void exchange(Model& model);
inline constexpr std::string_view k_exchanged = "light and viewer of the source";

/// The wavelengths [nm] of a spectral model; otherwise empty.
std::span<const float> wavelengths(const Model& model);
/// The wavelengths of a spectral model; R, G, B of any other model. It keeps a reference to `model`.
Channels channels(const Model& model);
Channels channels(const Model&&) = delete;

/// Size of a model's stored numbers, and of the tables that it needs in addition at run time.
std::size_t payload_bytes(const Model& model);
std::size_t auxiliary_bytes(const Model& model);

/// The model file: a safetensors container (8-byte little-endian length, JSON header, data) with F16 tensors. A
/// multivariate model has `coefficient` [J,3], `bandwidth` [J,N], `parameterization` [N,2], where needed `log_scale`
/// [J] and `exponent` [J,F], and for general lobes `centre` [J,N,2] (θ, φ in radians). Axial lobes have no `centre`:
/// the sign of the bandwidth chooses +z or −z. A spectral model has `coefficient` [J,C] and the metadata `wavelengths`
/// [nm], separated by blanks. A view-by-view model has `coefficient` [n,J,3], `bandwidth` [n,J] and `centre` [n,J,2],
/// the (θ, φ) of a centre minus those of its view's mirror direction. If it has an index texture, it also has
/// `aux.index`, U16 [6,s,s,8] or [s,s,8], and `aux.directions` [n,4], the sampled directions and a 0. A model of
/// Lambert and GGX has `diffuse` [3], and for its L lobes `roughness` [L], `facing` [L,3] (F0) and `grazing` [L] (F90).
/// A surface of renderers' parameters has a tensor for each row of `k_openpbr_parameters`, [1] or [3], those of a thin film
/// and of anisotropy only if it has them, and the metadata `exchanged_surface`, "true" or "false". A BSDF has the
/// tensors and the metadata of each part's model after the part's name and a point, as in `transmission_front.bandwidth`,
/// and for each of its beams, named by `k_beam_names`, `beam.NAME.angle` [rings] and `beam.NAME.share` [rings,3]; if a
/// ring has several nodes `beam.NAME.azimuths` [rings], their numbers, and `share` [nodes,3], of a grey beam [nodes,1].
std::vector<std::byte> write_model(const Model& model);
/// Errors: not a model file; tensors that are missing, of another type or shape, overlapping or with gaps between them;
/// numbers that are not finite or out of range; `wrong_kind`: a measurement, a stack. `file_name` appears in errors only.
Result<Model> read_model(std::span<const std::byte> bytes, const std::string& file_name);

/// Writes `write_model(model)` to the file at `path`, which holds its previous content if there is an error. Errors:
/// those of `write_file` (file.h); a coefficient above k_half_max; the provenance is too long to be read again.
Result<Done> save_model(const Model& model, const std::string& path);
/// Reads the model file at `path`. Errors: those of `read_file` (file.h) and of `read_model`; not enough memory.
Result<Model> load_model(const std::string& path);

/// Multivariate models of one form and size, one for each texel of a material.
struct ModelStack {
    std::vector<PmModel> models;       ///< T
    std::vector<float> error;          ///< T: of the fits, 0..k_half_max
    std::vector<std::uint16_t> state;  ///< T: of the fits, see `TexelState`
    std::map<std::string, std::string> provenance;
};
/// The file of a stack: the tensors of a model file with one more dimension in front, T, always with `log_scale`; and
/// `aux.error`, F16 [T], and `aux.state`, U16 [T].
std::vector<std::byte> write_stack(const ModelStack& stack);
/// Errors: as in `read_model`.
Result<ModelStack> read_stack(std::span<const std::byte> bytes, const std::string& file_name);

}  // namespace srbf
