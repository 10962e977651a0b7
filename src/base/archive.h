// Serialises values, member by member, for copies in other processes and for comparison. Only the same version of the
// library, on a processor of the same byte order, can read the bytes.
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

namespace SRBF_NAMESPACE {

template <typename T> inline constexpr bool is_list = false;
template <typename T> inline constexpr bool is_list<std::vector<T>> = true;
template <> inline constexpr bool is_list<std::string> = true;
template <typename T> inline constexpr bool is_map = false;
template <typename K, typename V> inline constexpr bool is_map<std::map<K, V>> = true;
template <typename T> inline constexpr bool is_optional = false;  // includes shared pointers
template <typename T> inline constexpr bool is_optional<std::shared_ptr<T>> = true;
template <typename T> inline constexpr bool is_optional<std::optional<T>> = true;
template <typename T> inline constexpr bool is_variant = false;
template <typename... T> inline constexpr bool is_variant<std::variant<T...>> = true;
template <typename T> inline constexpr bool is_array = false;
template <typename T, std::size_t n> inline constexpr bool is_array<std::array<T, n>> = true;
/// A type with a function `members(value, each)`, which calls each(member) for all members. It is written member by
/// member, since padding between them is undefined. If a function `complete(value)` exists, it is called after reading.
template <typename T>
concept HasMembers = requires(T& value) {
    members(value, [](auto&) {});
};

/// Appends each value to `bytes`.
struct ArchiveWriter {
    std::string bytes;

    template <typename T> void operator()(const T& value) {
        if constexpr (is_list<T>) {
            (*this)(std::uint64_t(value.size()));
            if constexpr (std::is_trivially_copyable_v<typename T::value_type>)
                bytes.append(reinterpret_cast<const char*>(value.data()),
                             value.size() * sizeof(typename T::value_type));
            else
                for (const auto& item : value) (*this)(item);
        } else if constexpr (is_map<T>) {
            (*this)(std::uint64_t(value.size()));
            for (const auto& [key, mapped] : value) (*this)(key), (*this)(mapped);
        } else if constexpr (is_optional<T>) {
            (*this)(bool(value));
            if (value) (*this)(*value);
        } else if constexpr (is_variant<T>) {
            (*this)(std::uint64_t(value.index()));
            std::visit(*this, value);
        } else if constexpr (HasMembers<T>) {
            members(const_cast<T&>(value), [this](auto& member) { (*this)(std::as_const(member)); });
        } else if constexpr (std::is_trivially_copyable_v<T>) {
            bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
        } else {
            static_assert(is_array<T>);
            for (const auto& item : value) (*this)(item);
        }
    }
};

/// Removes values that `ArchiveWriter` wrote from the beginning of `bytes`. Throws std::invalid_argument if the
/// bytes end too early or contain an unknown alternative of a variant.
struct ArchiveReader {
    std::string_view bytes;

    std::string_view take(std::uint64_t count) {
        if (count > bytes.size()) throw std::invalid_argument("pickled BRDF: it ends too early");
        const std::string_view taken = bytes.substr(0, std::size_t(count));
        bytes.remove_prefix(std::size_t(count));
        return taken;
    }
    template <typename T> T next() {
        T value{};
        (*this)(value);
        return value;
    }
    template <typename T> void operator()(T& value) {
        if constexpr (is_list<T>) {
            const auto count = next<std::uint64_t>();
            if (count > bytes.size()) take(count);  // throws: each item has at least one byte
            value.resize(std::size_t(count));
            if constexpr (std::is_trivially_copyable_v<typename T::value_type>) {
                const std::string_view from = take(count * sizeof(typename T::value_type));
                if (!from.empty()) std::memcpy(value.data(), from.data(), from.size());
            } else {
                for (auto& item : value) (*this)(item);
            }
        } else if constexpr (is_map<T>) {
            for (auto count = next<std::uint64_t>(); count > 0; --count) {
                auto key = next<typename T::key_type>();
                value[std::move(key)] = next<typename T::mapped_type>();
            }
        } else if constexpr (is_optional<T>) {
            using Content = std::remove_cvref_t<decltype(*value)>;
            if (!next<bool>()) return;
            if constexpr (std::is_same_v<T, std::optional<Content>>)
                value = next<Content>();
            else
                value = std::make_shared<Content>(next<Content>());
        } else if constexpr (is_variant<T>) {
            read_alternative(value, next<std::uint64_t>(), std::make_index_sequence<std::variant_size_v<T>>());
        } else if constexpr (HasMembers<T>) {
            members(value, [this](auto& member) { (*this)(member); });
            if constexpr (requires { complete(value); }) complete(value);
        } else if constexpr (std::is_trivially_copyable_v<T>) {
            std::memcpy(&value, take(sizeof value).data(), sizeof value);
        } else {
            static_assert(is_array<T>);
            for (auto& item : value) (*this)(item);
        }
    }

  private:
    template <typename T, std::size_t... i>
    void read_alternative(T& value, std::uint64_t index, std::index_sequence<i...>) {
        if (index >= sizeof...(i)) throw std::invalid_argument("pickled BRDF: it has an unknown table");
        ((index == i ? (*this)(value.template emplace<i>()) : void()), ...);
    }
};

template <typename T> std::string to_archive(const T& value) {
    ArchiveWriter writer;
    writer(value);
    return std::move(writer.bytes);
}

}  // namespace srbf
