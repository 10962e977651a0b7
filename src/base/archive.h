// Values as bytes, for copies in other processes and for comparison: their members, one after another. The bytes are of this
// version of the library and of processors with this order of bytes.
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

namespace srbf {

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
/// A type with `members(of, each)`, which calls each(member), is written member by member; its own bytes may have gaps of any
/// content. `complete(of)`, if it has that, is called after it was read.
template <typename T>
concept HasMembers = requires(T& of) {
    members(of, [](auto&) {});
};

/// Appends to `bytes`.
struct ArchiveWriter {
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

/// Takes from the beginning of `bytes` what `ArchiveWriter` wrote. Throws std::invalid_argument if they are of something else.
struct ArchiveReader {
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
            if constexpr (requires { complete(of); }) complete(of);
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

template <typename T> std::string archived(const T& of) {
    ArchiveWriter writer;
    writer(of);
    return std::move(writer.bytes);
}

}  // namespace srbf
