// The members of measurements and models, for copies in other processes and for comparison.
#pragma once
#include <algorithm>
#include <stdexcept>
#include <string>

#include "base/archive.h"
#include "measured/formats.h"
#include "models/kinds.h"
#include "srbf/load.h"

namespace srbf {

/// Calls each(member) for the members of one of the structs.
template <typename Each> void members(RglTable::VisibleNormals& of, const Each& each) {
    each(of.width), each(of.height), each(of.nodes), each(of.rows);
}
template <typename Each> void members(RglTable::Colours& of, const Each& each) {
    each(of.width), each(of.height), each(of.nodes);
}
template <typename Each> void members(RglTable::Profile& of, const Each& each) {
    each(of.width), each(of.height), each(of.nodes);
}
template <typename Each> void members(MerlTable& of, const Each& each) {
    each(of.size), each(of.cells), each(of.masked);
}
template <typename Each> void members(RglTable& of, const Each& each) {
    each(of.description), each(of.wavelengths), each(of.spectra), each(of.phi_l), each(of.symmetry), each(of.jacobian);
    each(of.theta_l), each(of.ndf), each(of.sigma), each(of.visible), each(of.colour);
}
template <typename Each> void members(UtiaTable& of, const Each& each) { each(of.cells), each(of.masked); }
template <typename Each> void members(MbsdfTable::Entry& of, const Each& each) { each(of.key), each(of.value); }
template <typename Each> void members(MbsdfTable& of, const Each& each) {
    each(of.polar), each(of.azimuths), each(of.grey), each(of.cells), each(of.masked), each(of.metadata);
    each(of.has_transmission);
}
template <typename Each> void members(ScatteredSamples& of, const Each& each) {
    each(of.description), each(of.isotropic), each(of.wavelengths), each(of.wl), each(of.wv), each(of.colour);
    each(of.spectrum), each(of.weight), each(of.masked), each(of.notes);
}
inline void complete(ScatteredSamples& samples) { make_index(samples); }
/// A format packs its own table.
template <typename Each> void members(EvaluatedTable& of, const Each& each) {
    std::string name(of.format), bytes = of.packed ? of.packed() : std::string();
    each(name), each(bytes);
    if (of.packed) return;
    const auto format = std::ranges::find(formats(), name, &Format::name);
    if (format == formats().end() || !format->unpack) throw std::invalid_argument("pickled BRDF: unknown format");
    of = format->unpack(bytes);
}
template <typename Each> void members(Beam& of, const Each& each) { each(of.theta), each(of.share), each(of.azimuths); }
template <typename Each> void members(BsdfTable::Band& of, const Each& each) {
    each(of.name), each(of.part), each(of.beam);
}
template <typename Each> void members(BsdfTable& of, const Each& each) {
    each(of.bands), each(of.chosen), each(of.description);
}
template <typename Each> void members(Measured& of, const Each& each) {
    each(of.source), each(of.format), each(of.bytes), each(of.exchanged), each(of.table);
}

template <typename Each> void members(Model& of, const Each& each) { each(of.model), each(of.provenance); }
/// Kinds of models have such a list themselves.
template <typename M, typename Each>
requires requires(M& of, const Each& each) { Stored<M>::for_members(of, each); }
void members(M& of, const Each& each) { Stored<M>::for_members(of, each); }

}  // namespace srbf
