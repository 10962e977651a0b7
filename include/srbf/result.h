// Errors of input as values.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "srbf/version.h"

SRBF_BEGIN

/// The kind of an error, for programs that react to it.
enum class ErrorCode {
    malformed,   ///< the content of a file or an array violates its format
    unreadable,  ///< a file cannot be read or written: missing, no permission, disk full, no memory for it
    wrong_kind,  ///< a fitted model where a measurement is expected, or the reverse
    argument,    ///< an option is out of its range, or two exclude each other
    no_data,     ///< nothing to fit: no value was measured, or all of them are 0
    cancelled,   ///< a progress callback or token cancelled the computation
};
std::string_view name(ErrorCode code);

/// An error: the part of an input that is wrong, the value expected there, and the value found.
struct Error {
    std::string source;                   ///< the file name, or the computation that reports the error
    std::optional<std::uint64_t> offset;  ///< byte (binary) or line (text), if known
    std::string what;                     ///< the part that is wrong, "field count"
    std::string expected;                 ///< "between 1 and 1024"; empty: none
    std::string found;                    ///< "0"; empty: none
    ErrorCode code = ErrorCode::malformed;
};

/// One line: "SOURCE: at OFFSET: WHAT: expected EXPECTED, found FOUND", without the parts that are empty.
std::string message(const Error& error);

/// Prints `what` to standard error and ends the program: for programming errors that must not pass in any build type.
[[noreturn]] void misused(std::string_view what);
/// A function of the host that is called in place of printing. It may throw. If it returns, the program ends.
using MisuseHandler = void (*)(std::string_view what);
/// Sets the handler of all threads and returns the one before. Null, the default, prints.
MisuseHandler set_misuse_handler(MisuseHandler handler);

/// A value or an Error. Dereferencing a Result without a value ends the program with the error's message, in every
/// build type; so does asking a Result with a value for its error.
template <typename T> class [[nodiscard]] Result {
  public:
    Result(T value) : content_(std::in_place_index<0>, std::move(value)) {}
    Result(Error error) : content_(std::in_place_index<1>, std::move(error)) {}

    bool ok() const { return content_.index() == 0; }
    explicit operator bool() const { return ok(); }

    T& operator*() & { return require(), *std::get_if<0>(&content_); }
    const T& operator*() const& { return require(), *std::get_if<0>(&content_); }
    T&& operator*() && { return require(), std::move(*std::get_if<0>(&content_)); }
    T* operator->() { return &**this; }
    const T* operator->() const { return &**this; }
    const Error& error() const {
        if (ok()) misused("error() of a Result that holds a value");
        return *std::get_if<1>(&content_);
    }

  private:
    void require() const {
        if (!ok()) misused(message(*std::get_if<1>(&content_)));
    }
    std::variant<T, Error> content_;
};

/// The value of a Result that only reports success.
struct Done {};

SRBF_END
