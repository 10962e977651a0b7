#include "extras/render/exr.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStdIO.h>
#include <fmt/format.h>

#include <cstring>
#include <exception>
#include <stdexcept>

#include "base/files.h"
#include "base/text.h"
#include "srbf/file.h"
#include "src/base/floating_point.h"

namespace SRBF_NAMESPACE {
namespace {

// The type of a file position differs between versions of the library.
using Position = decltype(std::declval<Imf::IStream&>().tellg());

class Source : public Imf::IStream {
  public:
    explicit Source(std::span<const std::byte> bytes) : IStream("memory"), bytes_(bytes) {}
    bool read(char* target, int count) override {
        if (count < 0 || std::uint64_t(count) > bytes_.size() - at_) throw std::runtime_error("the file ends early");
        std::memcpy(target, bytes_.data() + at_, std::size_t(count));
        at_ += std::size_t(count);
        return at_ < bytes_.size();
    }
    Position tellg() override { return at_; }
    void seekg(Position position) override {
        if (position > bytes_.size()) throw std::runtime_error("the file ends early");
        at_ = std::size_t(position);
    }

  private:
    std::span<const std::byte> bytes_;
    std::size_t at_ = 0;
};

/// The first line of the library's message.
std::string first_line(const std::exception& error) {
    const std::string_view message = error.what();
    return std::string(message.substr(0, std::min(message.find('\n'), std::size_t(200))));
}

/// Pixels at a distance of `stride` floats, starting at `first`.
Imf::Slice slice(const float* first, int width, int stride, std::int64_t x0, std::int64_t y0) {
    const auto step = std::int64_t(sizeof(float)) * stride;
    const auto* base = reinterpret_cast<const char*>(first) - step * (x0 + y0 * width);
    return {Imf::FLOAT, const_cast<char*>(base), std::size_t(step), std::size_t(step * width)};
}

/// Writes the channels of `frame`.
Result<Done> write_frame(const Imf::Header& header, const Imf::FrameBuffer& frame, int height,
                         const std::string& path) {
    Imf::StdOSStream sink;
    try {
        Imf::OutputFile file(sink, header);
        file.setFrameBuffer(frame);
        file.writePixels(height);
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {
        return Error{path, {}, "cannot be written as EXR", {}, first_line(error)};
    }
    return write_file(path, as_bytes(sink.str()));
}

}  // namespace

std::vector<Channel> channels_of(const Image& image, const std::string& layer, std::string_view names) {
    std::vector<Channel> channels;
    for (int c = 0; c < 3; ++c) {
        Channel& channel = channels.emplace_back(Channel{layer + names[std::size_t(c)], {}});
        for (const Rgb& pixel : image.pixels) channel.pixels.push_back(pixel[c]);
    }
    return channels;
}

Result<Done> write_exr(int width, int height, std::span<const Channel> channels, const std::string& path) {
    Imf::Header header(width, height);
    Imf::FrameBuffer frame;
    for (const Channel& channel : channels) {
        header.channels().insert(channel.name, Imf::Channel(Imf::FLOAT));
        frame.insert(channel.name, slice(channel.pixels.data(), width, 1, 0, 0));
    }
    return write_frame(header, frame, height, path);
}

Result<Done> write_half_exr(int width, int height, std::span<const std::string> names,
                            std::span<const std::uint16_t> halves, const std::string& path) {
    Imf::Header header(width, height);
    Imf::FrameBuffer frame;
    const std::size_t pixel = sizeof halves[0] * names.size();
    for (std::size_t i = 0; i < names.size(); ++i) {
        auto* const first = const_cast<std::uint16_t*>(&halves[i]);
        header.channels().insert(names[i], Imf::Channel(Imf::HALF));
        frame.insert(names[i], {Imf::HALF, reinterpret_cast<char*>(first), pixel, pixel * std::size_t(width)});
    }
    return write_frame(header, frame, height, path);
}

bool is_exr(std::span<const std::byte> bytes) {
    constexpr std::array<unsigned char, 4> magic{0x76, 0x2f, 0x31, 0x01};
    return bytes.size() >= 4 && std::memcmp(bytes.data(), magic.data(), 4) == 0;
}

namespace {

/// An attribute of a header, with the offset of its value in the file.
struct Attribute {
    std::string_view name, type, value;
    std::size_t offset;
};

/// The attributes of the first part, and in `end` the offset after them. No value if the text ends first.
std::optional<std::vector<Attribute>> attributes(std::string_view text, std::size_t& end) {
    constexpr std::size_t k_before = 8;  // the mark, and version and flags
    std::vector<Attribute> attributes;
    std::size_t offset = k_before;
    const auto word = [&]() -> std::optional<std::string_view> {
        const std::size_t zero = text.find('\0', offset);
        if (zero == text.npos) return {};
        const std::string_view result = text.substr(offset, zero - offset);
        offset = zero + 1;
        return result;
    };
    for (;;) {
        const auto name = word();
        if (!name) return {};
        end = offset;
        if (name->empty()) return attributes;
        const auto type = word();
        std::int32_t size;
        if (!type || text.size() - offset < sizeof size) return {};
        std::memcpy(&size, text.data() + offset, sizeof size);
        offset += sizeof size;
        if (size < 0 || std::size_t(size) > text.size() - offset) return {};
        attributes.push_back({*name, *type, text.substr(offset, std::size_t(size)), offset});
        offset += std::size_t(size);
    }
}

/// The numbers of an attribute, if it exists and has enough bytes.
template <typename T, std::size_t N>
std::optional<std::array<T, N>> numbers(const std::vector<Attribute>& attributes, std::string_view name) {
    const auto attribute = std::ranges::find(attributes, name, &Attribute::name);
    std::array<T, N> numbers;
    if (attribute == attributes.end() || attribute->value.size() < sizeof numbers) return {};
    std::memcpy(numbers.data(), attribute->value.data(), sizeof numbers);
    return numbers;
}

/// The rows and columns of a block of pixels, the unit of the file's compression.
std::array<std::int64_t, 2> block_of(const std::vector<Attribute>& attributes) {
    if (const auto tile = numbers<std::uint32_t, 2>(attributes, "tiles"))
        return {std::max<std::int64_t>((*tile)[1], 1), std::max<std::int64_t>((*tile)[0], 1)};
    constexpr std::array<std::int64_t, 10> rows{1, 1, 1, 16, 32, 16, 32, 32, 32, 256};  // rows a block, by compression
    const auto kind = numbers<std::uint8_t, 1>(attributes, "compression");
    return {kind && (*kind)[0] < rows.size() ? rows[(*kind)[0]] : 1, std::int64_t(1) << 32};
}

}  // namespace

Result<Done> check_exr_header(std::span<const std::byte> start, std::uint64_t size, const std::string& file_name) {
    constexpr std::size_t k_max_header = k_head_bytes;
    const auto text = as_text(start.first(std::min(start.size(), k_max_header)));
    std::size_t end = 0;
    const auto header = attributes(text, end);
    // Otherwise the library would allocate the size that an attribute declares.
    if (!header) return Error{file_name, end, "header", fmt::format("at most {} bytes", text.size()), "more"};
    const auto window = numbers<std::int32_t, 4>(*header, "dataWindow");
    if (!window) return Done{};
    const std::size_t offset = std::ranges::find(*header, "dataWindow", &Attribute::name)->offset;
    const std::int64_t width = std::int64_t((*window)[2]) - (*window)[0] + 1,
                       height = std::int64_t((*window)[3]) - (*window)[1] + 1;
    if (width < 1 || height < 1 || width > k_max_texels / height)
        return Error{file_name, offset, "dataWindow", fmt::format("1 to {} pixels", k_max_texels),
                     fmt::format("{} x {}", width, height)};
    // Lossy compression takes a fifth of a byte per pixel of a photograph; a small file may have a single colour.
    constexpr std::uint64_t k_always = std::uint64_t(1) << 21, k_pixels_per_byte = 8;
    const std::uint64_t max_pixels = k_always + k_pixels_per_byte * size;
    if (std::uint64_t(width * height) > max_pixels)
        return Error{file_name, offset, "dataWindow", fmt::format("at most {} pixels in {} bytes", max_pixels, size),
                     fmt::format("{} x {}", width, height)};
    // The file has the offset of each block, in 8 bytes.
    const auto [rows, columns] = block_of(*header);
    const std::int64_t blocks = ((height - 1) / rows + 1) * ((width - 1) / columns + 1);
    if (std::uint64_t(blocks) <= size / 8) return Done{};
    return Error{file_name, offset, "dataWindow", fmt::format("at most {} blocks of pixels", size / 8),
                 fmt::format("{}", blocks)};
}

Result<Image> read_exr(std::span<const std::byte> bytes, const std::string& file_name) {
    const StandardArithmetic mode;
    if (const auto valid = check_exr_header(bytes, bytes.size(), file_name); !valid) return valid.error();
    try {
        Source stream(bytes);
        Imf::InputFile file(stream, 1);
        const auto window = file.header().dataWindow();
        const std::int64_t width = std::int64_t(window.max.x) - window.min.x + 1,
                           height = std::int64_t(window.max.y) - window.min.y + 1;
        if (width < 1 || height < 1 || width > k_max_texels / height)
            return Error{
                file_name, {}, "pixels", fmt::format("1 to {}", k_max_texels), fmt::format("{} x {}", width, height)};
        for (const char* name : {"R", "G", "B"}) {
            const Imf::Channel* channel = file.header().channels().findChannel(name);
            if (channel && channel->xSampling == 1 && channel->ySampling == 1) continue;
            return Error{file_name, {}, fmt::format("channel {}", name), "complete", "incomplete"};
        }
        Image image(static_cast<int>(width), static_cast<int>(height));
        Imf::FrameBuffer frame;
        frame.insert("R", slice(&image.pixels[0].r, image.width, 3, window.min.x, window.min.y));
        frame.insert("G", slice(&image.pixels[0].g, image.width, 3, window.min.x, window.min.y));
        frame.insert("B", slice(&image.pixels[0].b, image.width, 3, window.min.x, window.min.y));
        file.setFrameBuffer(frame);
        file.readPixels(window.min.y, window.max.y);
        return image;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {
        return Error{file_name, {}, "OpenEXR file", "whole", first_line(error)};
    }
}

}  // namespace
