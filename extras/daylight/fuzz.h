// Fuzz targets.
#pragma once
#include <algorithm>

#include "srbf/daylight.h"

namespace SRBF_NAMESPACE {

/// Checks that a written matrix can be read, with the same number of bands.
inline void check_written_xml(const BsdfTable& table) {
    const std::string written = write_bsdf_xml(table);
    const auto again = read_bsdf_xml(std::as_bytes(std::span(written)), "f");
    require(again.ok() && again->bands.size() == table.bands.size(), "what is written is read");
}

/// Checks that beams are fractions of the light, and stay separate from the patches that they were taken from.
inline void check_bsdf_xml(std::span<const std::byte> bytes) {
    auto table = read_bsdf_xml(bytes, "f");
    if (table) {
        for (const Beam& beam : table->band().beam)
            for (const Vec3f& wl : {Vec3f{1, 0, 0}, {-0.5f, -0.5f, 1e-4f}, {0.6f, -0.7f, 0.3f}, {0, 0, 1}})
                for (int c = 0; c < 3; ++c)
                    require(fraction_at(beam, wl)[c] >= 0 && fraction_at(beam, wl)[c] <= 1, "a share");
        const auto& parts = table->band().part;
        if (std::ranges::none_of(parts, [](const auto& part) { return part && table_as<TreeTable>(*part); }))
            check_written_xml(*table);
    }
    check_measured(std::move(table));
}

inline const NamedTarget k_daylight_targets[] = {{"bsdf_xml", check_bsdf_xml}};

}  // namespace
