// The members of measurements and models, for copies in other processes and for comparison.
#pragma once
#include <algorithm>
#include <stdexcept>
#include <string>

#include "base/archive.h"
#include "measured/evaluated_table.h"
#include "measured/formats.h"
#include "models/kinds.h"
#include "srbf/load.h"

namespace srbf {

/// Calls each(member) for the members of a struct. There is one overload for each struct.
template <typename Each> void members(RglTable::VisibleNormals& value, const Each& each) {
    each(value.width), each(value.height), each(value.nodes), each(value.rows);
}
template <typename Each> void members(RglTable::Colours& value, const Each& each) {
    each(value.width), each(value.height), each(value.nodes);
}
template <typename Each> void members(RglTable::Profile& value, const Each& each) {
    each(value.width), each(value.height), each(value.nodes);
}
template <typename Each> void members(MerlTable& value, const Each& each) {
    each(value.size), each(value.cells), each(value.masked);
}
template <typename Each> void members(RglTable& value, const Each& each) {
    each(value.description), each(value.wavelengths), each(value.spectra), each(value.phi_l), each(value.symmetry),
        each(value.jacobian);
    each(value.theta_l), each(value.ndf), each(value.sigma), each(value.visible), each(value.colour);
}
template <typename Each> void members(UtiaTable& value, const Each& each) { each(value.cells), each(value.masked); }
template <typename Each> void members(MbsdfTable::Entry& value, const Each& each) {
    each(value.key), each(value.value);
}
template <typename Each> void members(MbsdfTable& value, const Each& each) {
    each(value.polar), each(value.azimuths), each(value.grey), each(value.cells), each(value.masked),
        each(value.metadata);
    each(value.has_transmission);
}
template <typename Each> void members(ScatteredSamples& value, const Each& each) {
    each(value.description), each(value.isotropic), each(value.wavelengths), each(value.wl), each(value.wv),
        each(value.colour);
    each(value.spectrum), each(value.weight), each(value.masked), each(value.notes), each(value.receiver);
}
inline void complete(ScatteredSamples& samples) { make_index(samples); }
/// The format of a table packs and unpacks it.
template <typename Each> void members(EvaluatedTable& value, const Each& each) {
    const TableFunctions* const known = value.functions.get();
    std::string name(known ? known->format : std::string_view()), bytes = known ? known->packed() : std::string();
    each(name), each(bytes);
    if (known) return;
    const auto format = std::ranges::find(formats(), name, &Format::name);
    if (format == formats().end() || !format->unpack) throw std::invalid_argument("pickled BRDF: unknown format");
    value = format->unpack(bytes);
}
template <typename Each> void members(Beam& value, const Each& each) {
    each(value.theta), each(value.share), each(value.azimuths);
}
template <typename Each> void members(BsdfTable::Band& value, const Each& each) {
    each(value.name), each(value.part), each(value.beam);
}
template <typename Each> void members(BsdfTable& value, const Each& each) {
    each(value.bands), each(value.chosen), each(value.description);
}
template <typename Each> void members(Measured& value, const Each& each) {
    each(value.source), each(value.format), each(value.bytes), each(value.exchanged), each(value.table);
}

template <typename Each> void members(Model& value, const Each& each) { each(value.model), each(value.provenance); }
/// A kind of model has a list of its own members.
template <typename M, typename Each>
requires requires(M& value, const Each& each) { Kind<M>::for_members(value, each); }
void members(M& value, const Each& each) { Kind<M>::for_members(value, each); }

}  // namespace srbf
