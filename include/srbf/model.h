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
#include "srbf/models/ggx.h"
#include "srbf/models/openpbr.h"
#include "srbf/models/pm.h"
#include "srbf/models/su.h"
#include "srbf/result.h"

SRBF_BEGIN

struct Model;
/// A BSDF: a model for each part, in the frame of that part (brdf.h), none of them a BSDF itself, and its beams.
struct BsdfModel {
    Parts<Model> part;
    Beams beam;
};
/// f(wl, wv) on either side, without the beams.
Rgb value(const BsdfModel& model, Vec3f wl, Vec3f wv);

/// All kinds of models, and the requests for those that are fitted.
using AnyModel = std::variant<PmModel, SuModel, GgxModel, BsdfModel, OpenPbrModel>;
using AnyRequest = std::variant<PmRequest, SuRequest, GgxRequest, OpenPbrRequest>;

/// The content of a model file: a model and its provenance.
struct Model {
    AnyModel model;
    std::map<std::string, std::string> provenance;  ///< source file, options, errors, version
};
/// The kind of a model as its file states it: "bsdf", or the name in its request.
std::string_view kind(const Model& model);

/// f(wl, wv); for a BSDF on either side, without the beams.
Rgb value(const Model& model, Vec3f wl, Vec3f wv);

/// f[i] = value(model, wl[i], wv[i]), with the widest SIMD instructions of the machine. The spans have the same length.
/// The values of a multivariate model are within 1e-4 of `value` or 1e-6 of the model's peak.
void evaluate(const Model& model, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f);
/// `model` as an `Evaluate`. It keeps a reference to `model`.
Evaluate evaluator(const Model& model);

/// True if f_r depends only on the difference of the azimuths by construction: not with general lobes.
bool is_isotropic(const Model& model);
/// Exchanges light and viewer: f_r(wl, wv) of the result is f_r(wv, wl) of the argument. The provenance of a model of
/// exchanged data has "exchanged".
void exchange(Model& model);

/// The wavelengths [nm] of a spectral model; otherwise empty.
std::span<const float> wavelengths(const Model& model);
/// The wavelengths of a spectral model; R, G, B of any other model. It keeps a reference to `model`.
Channels channels(const Model& model);
Channels channels(const Model&&) = delete;

/// Size of a model's stored numbers, and of the tables that it needs in addition at run time.
std::size_t payload_bytes(const Model& model);
std::size_t auxiliary_bytes(const Model& model);

/// The model file: a safetensors container of 16-bit floats, described in docs/formats.md.
std::vector<std::byte> write_model(const Model& model);
/// Reads the bytes of a model file. Returns an error if they are none; if tensors are missing, have another type or
/// shape, overlap or leave gaps; or if numbers are not finite or out of range. The code is `wrong_kind` for a
/// measurement or a map. `file_name` appears in errors only.
Result<Model> read_model(std::span<const std::byte> bytes, const std::string& file_name);

/// Writes `write_model(model)` to the file at `path`, which holds its previous content if there is an error. Returns an
/// error if `write_file` (file.h) does, if a coefficient is above k_half_max, or if the provenance is too long to be
/// read again.
Result<Done> save_model(const Model& model, const std::string& path);
/// Reads the model file at `path`. Returns an error if `read_file` (file.h) or `read_model` does, or if memory does not
/// suffice.
Result<Model> load_model(const std::string& path);

SRBF_END
