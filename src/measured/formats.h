// The formats of measurements: recognition, readers and writers.
#pragma once
#include "brdf/parts.h"
#include "srbf/elementary.h"
#include "srbf/measured.h"
#include "srbf/progress.h"

SRBF_BEGIN

/// The source of a table: a BRDF or BSDF, with its properties.
struct TableSource {
    Evaluate values;  ///< `signed_value` of a measurement or `value` of a model, to which it keeps a reference
    bool isotropic = true, two_sided = false;
    /// The parts that are known, also by reciprocity from their counterparts. A BRDF has the front's reflection alone.
    std::array<bool, k_parts> has{true};
    Beams beams = {};
    const Measured* measured = nullptr;  ///< null for a model
    Channels spectra = {};               ///< its spectra, if it has some; otherwise without wavelengths
};
/// Sets the parts of a source to the parts of a BSDF. A BSDF without any known part becomes a black reflection.
template <typename B> void set_parts(TableSource& source, const Parts<B>& parts, const Beams& beams) {
    source.two_sided = true;
    for (std::size_t p = 0; p < k_parts; ++p) source.has[p] = is_known(parts, beams, Part(p));
    source.has[0] |= source.has == std::array<bool, k_parts>{};
    source.beams = complete_beams(parts, beams);
}
TableSource table_source(const Measured& measured);
TableSource table_source(const Measured&&) = delete;

/// An option of one writer: its name on the command line, and its values. The first value is the default.
struct WriterOption {
    std::string_view name, help;
    std::span<const std::string_view> values;
};

struct TableOptions {
    std::string description;           ///< describes the material
    int directions = 64;               ///< CSV of a table or a model holds all pairs of this many directions
    double max_theta = 89 * k_degree;  ///< bound on θ of these directions [rad]
    std::string choice = {};           ///< a value of the format's `WriterOption`; empty for the default
    bool spectra = true;               ///< RGL files hold spectra beside colours, see `write_rgl`
    int threads = 0;                   ///< number of threads; 0: all of the machine. The result does not depend on it
    ProgressToken progress = {};       ///< the token that can cancel the writer
};

struct Format {
    std::string_view name;
    bool is_text = false;
    /// True if a file is of the format, by its first bytes.
    bool (*recognise)(std::span<const std::byte> head) = nullptr;
    /// Reads a measurement without the index of samples, the name and the size, which `read_as` adds.
    Result<Measured> (*read)(std::span<const std::byte> bytes, const std::string& file_name,
                             const ReadOptions& options) = nullptr;
    /// The size of a file that begins with `head`, by which a format without a magic number is recognised; 0 if it is
    /// of another format. Null for formats with a magic number.
    std::uint64_t (*size)(std::span<const std::byte> head) = nullptr;

    std::string_view extension = {};  ///< the extension of written files; empty for a format without a writer
    std::string_view used_by = {};    ///< names the format where `extension` is ambiguous
    bool anisotropic = false;         ///< written files may hold anisotropic BRDFs
    bool one_sided = false;           ///< written files hold no BSDF
    bool beams = false;               ///< written files hold the beams of a BSDF
    Result<std::vector<std::byte>> (*write)(const TableSource& source, const TableOptions& options) = nullptr;
    const WriterOption* option = nullptr;
};

/// All formats, in the order in which they are tried.
std::span<const Format> formats();
/// The first format that recognises the bytes; otherwise null.
const Format* format_of(std::span<const std::byte> bytes);
/// The format with a writer whose extension the path ends in, the longest one of several; null if there is none.
const Format* format_written_to(std::string_view path);
/// Reads a file of a known format. Returns an error if the format's reader does.
Result<Measured> read_as(const Format& format, std::span<const std::byte> bytes, const std::string& file_name,
                         const ReadOptions& options = {});
/// The largest size of a file that begins with `head` in any format.
std::uint64_t max_bytes(std::span<const std::byte> head);
/// "RGL, MBSDF, ... or UTIA".
std::string names_of_formats();
/// ".bsdf, .mbsdf, ... or .csv": the extensions of formats with a writer.
std::string extensions_of_formats();

SRBF_END
