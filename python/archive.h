// Measurements and models as bytes, for copies in other processes and for comparison: their members, one after another.
// The bytes are of this version of the library and of processors with this order of bytes.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

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
template <typename Each> void members(AngleBasis& of, const Each& each) { each(of.name), each(of.rings); }
template <typename Each> void members(KlemsTable& of, const Each& each) {
    each(of.incident), each(of.outgoing), each(of.cells), each(of.beam), each(of.masked);
}
template <typename Each> void members(TensorTree& of, const Each& each) {
    each(of.rank), each(of.root), each(of.nodes), each(of.leaves);
}
template <typename Each> void members(TreeTable& of, const Each& each) { each(of.y), each(of.chromaticity); }
template <typename Each> void members(ScatterTable::Slice& of, const Each& each) {
    each(of.theta_l), each(of.polar), each(of.azimuth), each(of.f);
}
template <typename Each> void members(ScatterTable& of, const Each& each) {
    each(of.about_mirror), each(of.transmission), each(of.rotation), each(of.first), each(of.slices), each(of.tint);
    each(of.masked), each(of.channels);
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

template <typename T> inline constexpr bool is_list = false;
template <typename T> inline constexpr bool is_list<std::vector<T>> = true;
template <> inline constexpr bool is_list<std::string> = true;
template <typename T> inline constexpr bool is_map = false;
template <typename K, typename V> inline constexpr bool is_map<std::map<K, V>> = true;
template <typename T> inline constexpr bool is_optional = false;  // or a pointer to what it shares
template <typename T> inline constexpr bool is_optional<std::shared_ptr<T>> = true;
template <typename T> inline constexpr bool is_optional<std::optional<T>> = true;
template <typename T> inline constexpr bool is_variant = false;
template <typename... T> inline constexpr bool is_variant<std::variant<T...>> = true;
template <typename T> inline constexpr bool is_array = false;
template <typename T, std::size_t n> inline constexpr bool is_array<std::array<T, n>> = true;
/// Whether it is written member by member; its own bytes may have gaps of any content.
template <typename T>
concept HasMembers = requires(T& of) {
    members(of, [](auto&) {});
};

/// Appends to `bytes`.
struct Writer {
    std::string bytes;

    template <typename T> void operator()(const T& of) {
        if constexpr (is_list<T>) {
            (*this)(std::uint64_t(of.size()));
            if constexpr (std::is_trivially_copyable_v<typename T::value_type>)
                bytes.append(reinterpret_cast<const char*>(of.data()), of.size() * sizeof(typename T::value_type));
            else
                for (const auto& one : of) (*this)(one);
        } else if constexpr (is_map<T>) {
            (*this)(std::uint64_t(of.size()));
            for (const auto& [key, value] : of) (*this)(key), (*this)(value);
        } else if constexpr (is_optional<T>) {
            (*this)(bool(of));
            if (of) (*this)(*of);
        } else if constexpr (is_variant<T>) {
            (*this)(std::uint64_t(of.index()));
            std::visit(*this, of);
        } else if constexpr (HasMembers<T>) {
            members(const_cast<T&>(of), [this](auto& member) { (*this)(std::as_const(member)); });
        } else if constexpr (std::is_trivially_copyable_v<T>) {
            bytes.append(reinterpret_cast<const char*>(&of), sizeof of);
        } else {
            static_assert(is_array<T>);
            for (const auto& one : of) (*this)(one);
        }
    }
};

/// Takes from the beginning of `bytes` what `Writer` wrote.
struct Reader {
    std::string_view bytes;

    std::string_view take(std::uint64_t count) {
        if (count > bytes.size()) throw std::invalid_argument("pickled BRDF: it ends too early");
        const std::string_view taken = bytes.substr(0, std::size_t(count));
        bytes.remove_prefix(std::size_t(count));
        return taken;
    }
    template <typename T> T next() {
        T of{};
        (*this)(of);
        return of;
    }
    template <typename T> void operator()(T& of) {
        if constexpr (is_list<T>) {
            const auto count = next<std::uint64_t>();
            if (count > bytes.size()) take(count);  // an item has at least a byte
            of.resize(std::size_t(count));
            if constexpr (std::is_trivially_copyable_v<typename T::value_type>) {
                const std::string_view from = take(count * sizeof(typename T::value_type));
                if (!from.empty()) std::memcpy(of.data(), from.data(), from.size());
            } else {
                for (auto& one : of) (*this)(one);
            }
        } else if constexpr (is_map<T>) {
            for (auto count = next<std::uint64_t>(); count > 0; --count) {
                auto key = next<typename T::key_type>();
                of[std::move(key)] = next<typename T::mapped_type>();
            }
        } else if constexpr (is_optional<T>) {
            using Held = std::remove_cvref_t<decltype(*of)>;
            if (!next<bool>()) return;
            if constexpr (std::is_same_v<T, std::optional<Held>>)
                of = next<Held>();
            else
                of = std::make_shared<Held>(next<Held>());
        } else if constexpr (is_variant<T>) {
            alternative(of, next<std::uint64_t>(), std::make_index_sequence<std::variant_size_v<T>>());
        } else if constexpr (HasMembers<T>) {
            members(of, [this](auto& member) { (*this)(member); });
            if constexpr (std::is_same_v<T, ScatteredSamples>) make_index(of);
        } else if constexpr (std::is_trivially_copyable_v<T>) {
            std::memcpy(&of, take(sizeof of).data(), sizeof of);
        } else {
            static_assert(is_array<T>);
            for (auto& one : of) (*this)(one);
        }
    }

  private:
    template <typename T, std::size_t... i> void alternative(T& of, std::uint64_t index, std::index_sequence<i...>) {
        if (index >= sizeof...(i)) throw std::invalid_argument("pickled BRDF: it has an unknown table");
        ((index == i ? (*this)(of.template emplace<i>()) : void()), ...);
    }
};

}  // namespace srbf
