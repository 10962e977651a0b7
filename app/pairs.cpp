#include "app/pairs.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "base/text.h"
#include "srbf/file.h"

namespace srbf {

Result<Done> PairParser::take_header(std::uint64_t number) {
    for (std::size_t c = 0; c < k_pair_columns.size(); ++c) {
        const auto found = std::ranges::find(fields_, k_pair_columns[c]);
        if (found == fields_.end())
            return at_line(file_name_, number, "header", fmt::format("a column {}", k_pair_columns[c]), "none");
        column_[c] = std::size_t(found - fields_.begin());
    }
    has_header_ = true;
    return Done{};
}

Result<Done> PairParser::take(std::string_view line, std::uint64_t number, DirectionPairs& pairs) {
    if (line.starts_with('#')) return Done{};  // a comment
    split_fields(line, fields_);
    if (!has_header_) return take_header(number);
    std::array<std::string, 6> text;
    std::array<double, 6> x{};
    for (std::size_t c = 0; c < x.size(); ++c) {
        const std::string_view field = column_[c] < fields_.size() ? fields_[column_[c]] : std::string_view();
        const auto parsed = to_number<double>(field);
        if (!parsed || !std::isfinite(*parsed))
            return at_line(file_name_, number, fmt::format("column {}", k_pair_columns[c]), "a number", quoted(field));
        x[c] = *parsed;
        text[c] = field;
    }
    const Vec3d wl{x[0], x[1], x[2]}, wv{x[3], x[4], x[5]};
    for (const auto& [what, w] : {std::pair("direction wl", wl), {"direction wv", wv}}) {
        const double length = std::sqrt(dot(w, w));
        if (!(std::abs(length - 1) <= 0.01))
            return at_line(file_name_, number, what, "length 1", fmt::format("{:.6g}", length));
    }
    pairs.wl.push_back(to_float(normalize(wl)));
    pairs.wv.push_back(to_float(normalize(wv)));
    pairs.text.push_back(std::move(text));
    return Done{};
}

Result<Done> PairParser::finish() const {
    if (has_header_) return Done{};
    return at_line(file_name_, 1, "header", "columns wl_x to wv_z", "an empty file");
}

Result<std::optional<std::string_view>> FileLines::next() {
    for (;;) {
        if (const auto line = lines_.next()) return line;
        if (at_end_) return std::optional<std::string_view>();
        if (const auto read = read_block(); !read) return read.error();
    }
}

Result<Done> FileLines::read_block() {
    constexpr std::size_t k_block = std::size_t(1) << 20;
    lines_before_ += lines_.number();
    lines_ = Lines({});
    std::vector<std::byte> block(block_.begin() + std::ptrdiff_t(complete_), block_.end());  // begins the next line
    const std::size_t kept = block.size();
    block.resize(k_block);
    const auto count = file_.read(std::span(block).subspan(kept));
    if (!count) return count.error();
    block.resize(kept + *count);
    at_end_ = block.size() < k_block;
    const auto end = std::find(block.rbegin(), block.rend(), std::byte('\n'));
    complete_ = at_end_ ? block.size() : std::size_t(block.rend() - end);
    if (complete_ == 0 && !at_end_)
        return at_line(file_.path(), number() + 1, "length", fmt::format("less than {} bytes", k_block), "more");
    block_ = std::move(block);
    lines_ = Lines(as_text(std::span(block_).first(complete_)));
    return Done{};
}

Result<PairReader> PairReader::open(const std::string& path) {
    auto file = FileReader::open(path);
    if (!file) return file.error();
    return PairReader(*std::move(file));
}

Result<DirectionPairs> PairReader::next(std::size_t max_count) {
    DirectionPairs pairs;
    while (pairs.wl.size() < max_count) {
        const auto line = lines_.next();
        if (!line) return line.error();
        if (!*line) {
            if (const auto complete = parser_.finish(); !complete) return complete.error();
            break;
        }
        if (const auto taken = parser_.take(**line, lines_.number(), pairs); !taken) return taken.error();
    }
    return pairs;
}

Result<DirectionPairs> load_pairs(const std::string& path) {
    return within_memory(path, [&]() -> Result<DirectionPairs> {
        auto reader = PairReader::open(path);
        if (!reader) return reader.error();
        return reader->next(std::numeric_limits<std::size_t>::max());
    });
}

}  // namespace srbf
