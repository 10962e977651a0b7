#include "render/exr.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <exception>
#include <stdexcept>

#include "srbf/file.h"

namespace srbf {
namespace {

// The type of a file position differs between versions of the library.
using Position = decltype(std::declval<Imf::IStream&>().tellg());

class Source : public Imf::IStream {
  public:
    explicit Source(std::span<const std::byte> bytes) : IStream("memory"), bytes_(bytes) {}
    bool read(char* to, int count) override {
        if (count < 0 || std::uint64_t(count) > bytes_.size() - at_) throw std::runtime_error("the file ends early");
        std::memcpy(to, bytes_.data() + at_, std::size_t(count));
        at_ += std::size_t(count);
        return at_ < bytes_.size();
    }
    Position tellg() override { return at_; }
    void seekg(Position to) override {
        if (to > bytes_.size()) throw std::runtime_error("the file ends early");
        at_ = std::size_t(to);
    }

  private:
    std::span<const std::byte> bytes_;
    std::size_t at_ = 0;
};

class Sink : public Imf::OStream {
  public:
    Sink() : OStream("memory") {}
    void write(const char* from, int count) override {
        bytes.resize(std::max(bytes.size(), at_ + std::size_t(count)));
        std::memcpy(bytes.data() + at_, from, std::size_t(count));
        at_ += std::size_t(count);
    }
    Position tellp() override { return at_; }
    void seekp(Position to) override { at_ = std::size_t(to); }

    std::vector<std::byte> bytes;

  private:
    std::size_t at_ = 0;
};

/// The first line of the library's message.
std::string said(const std::exception& error) {
    const std::string_view all = error.what();
    return std::string(all.substr(0, std::min(all.find('\n'), std::size_t(200))));
}

/// Pixels at a distance of `stride` floats, starting at `first`.
Imf::Slice slice(const float* first, int width, int stride, std::int64_t x0, std::int64_t y0) {
    const auto step = std::int64_t(sizeof(float)) * stride;
    const auto* base = reinterpret_cast<const char*>(first) - step * (x0 + y0 * width);
    return {Imf::FLOAT, const_cast<char*>(base), std::size_t(step), std::size_t(step * width)};
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
    Sink sink;
    try {
        Imf::Header header(width, height);
        Imf::FrameBuffer frame;
        for (const Channel& channel : channels) {
            header.channels().insert(channel.name, Imf::Channel(Imf::FLOAT));
            frame.insert(channel.name, slice(channel.pixels.data(), width, 1, 0, 0));
        }
        Imf::OutputFile file(sink, header);
        file.setFrameBuffer(frame);
        file.writePixels(height);
    } catch (const std::exception& error) {
        return Error{path, {}, "cannot be written as EXR", {}, said(error)};
    }
    return write_file(path, sink.bytes);
}

bool is_exr(std::span<const std::byte> bytes) {
    constexpr std::array<unsigned char, 4> magic{0x76, 0x2f, 0x31, 0x01};
    return bytes.size() >= 4 && std::memcmp(bytes.data(), magic.data(), 4) == 0;
}

Result<Done> check_exr_size(std::span<const std::byte> start, const std::string& file_name) {
    // The attribute's name, type and size, then the first and last column and row.
    constexpr std::string_view attribute("dataWindow\0box2i\0\x10\0\0\0", 21);
    const std::string_view text(reinterpret_cast<const char*>(start.data()), start.size());
    const std::size_t at = text.find(attribute);
    std::array<std::int32_t, 4> window;
    if (at == text.npos || text.size() - at < attribute.size() + sizeof window) return Done{};
    std::memcpy(window.data(), text.data() + at + attribute.size(), sizeof window);
    const std::int64_t width = std::int64_t(window[2]) - window[0] + 1,
                       height = std::int64_t(window[3]) - window[1] + 1;
    if (width >= 1 && height >= 1 && width <= k_most_texels / height) return Done{};
    return Error{file_name, at, "dataWindow", fmt::format("1 to {} pixels", k_most_texels),
                 fmt::format("{} x {}", width, height)};
}

Result<Image> read_exr(std::span<const std::byte> bytes, const std::string& file_name) {
    try {
        Source stream(bytes);
        Imf::InputFile file(stream, 1);
        const auto window = file.header().dataWindow();
        const std::int64_t width = std::int64_t(window.max.x) - window.min.x + 1,
                           height = std::int64_t(window.max.y) - window.min.y + 1;
        // No compression reduces a picture this much.
        const std::int64_t most = std::min(k_most_texels, 4096 * std::int64_t(bytes.size()));
        if (width < 1 || height < 1 || width > most / height)
            return Error{file_name, {}, "pixels", fmt::format("1 to {}", most), fmt::format("{} x {}", width, height)};
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
    } catch (const std::exception& error) {
        return Error{file_name, {}, "OpenEXR file", "whole", said(error)};
    }
}

}  // namespace srbf
