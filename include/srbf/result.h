// Errors of input are values: level 0.
#pragma once
#include <cassert>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>

namespace srbf {

/// What is wrong with an input, where, what was expected there and what was found.
struct Error {
    std::string source;                   ///< the file's name
    std::optional<std::uint64_t> offset;  ///< byte (binary) or line (text), where one can be named
    std::string what;                     ///< the part at fault, "field count"
    std::string expected;                 ///< "between 1 and 1024"; empty: none
    std::string found;                    ///< "0"; empty: none
};

/// One line: "SOURCE: at OFFSET: WHAT: expected EXPECTED, found FOUND", leaving out what is empty.
std::string message(const Error& error);

/// A value or the Error that kept it from being made. Dereferencing an error is the programmer's error.
template <typename T> class [[nodiscard]] Result {
  public:
    Result(T value) : content_(std::in_place_index<0>, std::move(value)) {}
    Result(Error error) : content_(std::in_place_index<1>, std::move(error)) {}

    bool ok() const { return content_.index() == 0; }
    explicit operator bool() const { return ok(); }

    T& operator*() & { return assert(ok()), *std::get_if<0>(&content_); }
    const T& operator*() const& { return assert(ok()), *std::get_if<0>(&content_); }
    T&& operator*() && { return assert(ok()), std::move(*std::get_if<0>(&content_)); }
    T* operator->() { return &**this; }
    const T* operator->() const { return &**this; }
    const Error& error() const { return assert(!ok()), *std::get_if<1>(&content_); }

  private:
    std::variant<T, Error> content_;
};

/// The value of a Result that carries nothing but success.
struct Done {};

}  // namespace srbf
