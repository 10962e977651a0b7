#include "measured/formats/write.h"

#include "brdf/parts.h"
#include "brdf/values.h"
#include "measured/formats/rows.h"
#include "measured/samples.h"
#include "srbf/convert.h"

namespace SRBF_NAMESPACE {

namespace {

/// CSV of all parts.
std::string csv_of_both_sides(const TableSource& source, const TableOptions& options) {
    ScatteredSamples all;
    all.isotropic = source.isotropic;
    for (std::size_t p = 0; p < k_parts; ++p) {
        if (!source.has[p]) continue;
        const Part part = Part(p);
        const ScatteredSamples samples =
            to_samples(part_of(source.values, part), source.isotropic, options.directions, options.max_theta);
        for (std::size_t i = 0; i < samples.wl.size(); ++i) {
            all.wl.push_back(to_side(samples.wl[i], side_of_light(part)));
            all.wv.push_back(to_side(samples.wv[i], side_of_viewer(part)));
            all.colour.push_back(samples.colour[i]);
        }
    }
    return "# both sides\n" + write_csv(all, options.progress);
}

}  // namespace

Result<std::vector<std::byte>> write_as_merl(const TableSource& source, const TableOptions& options) {
    return write_merl(to_merl(non_negative(source.values), k_merl_size, options.threads));
}

Result<std::vector<std::byte>> write_as_rgl(const TableSource& source, const TableOptions& options) {
    const RglTable table = to_rgl(source.values, {.description = options.description,
                                                  .spectra = options.spectra ? source.spectra : Channels{},
                                                  .threads = options.threads});
    if (options.progress.cancelled()) return std::vector<std::byte>();
    return write_rgl(table, options.spectra);
}

Result<std::vector<std::byte>> write_as_mbsdf(const TableSource& source, const TableOptions& options) {
    const MbsdfOptions mbsdf{.metadata = {{"description", options.description}}, .threads = options.threads};
    if (!source.has[std::size_t(Part::transmission_front)]) return write_mbsdf(to_mbsdf(source.values, mbsdf));
    const MbsdfTable transmission = to_mbsdf(part_of(source.values, Part::transmission_front), mbsdf);
    return write_mbsdf(to_mbsdf(source.values, mbsdf), &transmission);
}

Result<std::vector<std::byte>> write_as_csv(const TableSource& source, const TableOptions& options) {
    if (source.two_sided) return bytes_of(csv_of_both_sides(source, options));
    if (const auto* samples = source.measured ? std::get_if<ScatteredSamples>(&source.measured->table) : nullptr)
        return bytes_of(write_csv(*samples, options.progress));
    ScatteredSamples samples = to_samples(source.values, source.isotropic, options.directions, options.max_theta);
    set_spectra(samples, source.spectra);
    return bytes_of(write_csv(samples, options.progress));
}

}  // namespace srbf
