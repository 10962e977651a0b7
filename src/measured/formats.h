// The formats of measurements: how files of each are recognised, read and written.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "srbf/elementary.h"
#include "srbf/measured.h"
#include "srbf/progress.h"

namespace [[gnu::visibility("default")]] srbf {

/// The source of a table: a BRDF or BSDF, with its properties.
struct TableSource {
    Evaluate values;  ///< `signed_value` of a measurement, `value` of a model; keeps a reference to it
    bool isotropic = true, two_sided = false;
    /// Parts that are known, or answered by their counterparts; of a BRDF the front's reflection alone.
    std::array<bool, k_parts> has{true};
    Beams beams = {};
    const Measured* measured = nullptr;  ///< null: a model
};
TableSource table_source(const Measured& measured);
TableSource table_source(const Measured&&) = delete;

/// An option that one writer reads: its name on the command line, and its values, of which the first is the default.
struct WriterOption {
    std::string_view name, help;
    std::span<const std::string_view> values;
};

struct TableOptions {
    std::string description;           ///< of the material
    int directions = 64;               ///< CSV of tables and models: all pairs of this many directions
    double max_theta = 89 * k_degree;  ///< [rad], of these directions
    std::string choice = {};           ///< a value of the format's `WriterOption`; empty: the first
    bool spectra = true;               ///< RGL: spectra beside the colours, see `write_rgl`
    int threads = 0;                   ///< 0: as many as the machine has; the result does not depend on it
    ProgressToken progress = {};       ///< for cancellation
};

struct Format {
    std::string_view name;
    bool is_text = false;  ///< its first kilobytes are text
    /// True if a file, or its first bytes, is of the format.
    bool (*recognise)(std::span<const std::byte> head) = nullptr;
    /// A measurement without the index of samples; `read_as` adds it, the name and the size. `options`: how columns are
    /// read.
    Result<Measured> (*read)(std::span<const std::byte> bytes, const std::string& file_name,
                             const ReadOptions& options) = nullptr;
    /// For a format without a mark: the size of a file that begins so, by which it is recognised; 0: it is of another
    /// format. Null for formats with a mark.
    std::uint64_t (*size)(std::span<const std::byte> head) = nullptr;

    std::string_view extension = {};  ///< of files that are written; empty: none are
    std::string_view used_by = {};    ///< whose files these are, where `extension` does not tell
    bool anisotropic = false;         ///< files hold anisotropic BRDFs too
    bool one_sided = false;           ///< files hold no BSDF
    Result<std::vector<std::byte>> (*write)(const TableSource& source, const TableOptions& options) = nullptr;
    const WriterOption* option = nullptr;
    /// The table that an `EvaluatedTable` of the format has `packed`.
    EvaluatedTable (*unpack)(std::string_view bytes) = nullptr;
};

/// All formats, in the order in which they are tried.
std::span<const Format> formats();
/// The first format that recognises the bytes; otherwise null.
const Format* format_of(std::span<const std::byte> bytes);
/// The format whose files have the longest extension that the name of a file ends in; null if none is written so.
const Format* format_written_to(std::string_view path);
/// Reads a file of a format, whatever it begins with. Errors: those of the format.
Result<Measured> read_as(const Format& format, std::span<const std::byte> bytes, const std::string& file_name,
                         const ReadOptions& options = {});
/// The bytes that a file may have that begins with `head`, by all formats.
std::uint64_t most_bytes(std::span<const std::byte> head);
/// "RGL, MBSDF, .. or UTIA".
std::string names_of_formats();
/// ".bsdf, .mbsdf, .. or .csv" of those that are written.
std::string extensions_of_formats();

}  // namespace srbf
