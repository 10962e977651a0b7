// The coefficients of maps as OpenEXR.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>

#include "base/half.h"
#include "command.h"
#include "models.h"

namespace srbf::map_exr_test {
namespace {

using MapExr = ProgramTest;

constexpr std::size_t k_width = 8, k_height = 4;

TEST_F(MapExr, MapsAreWrittenAsOpenExr) {
    std::mt19937_64 random(1);
    const TexelMap map = random_map(random, {true, true, 5, 3, 60, PmForm::extended}, k_width, k_height);
    write_text(folder / "map.srbf", as_text(write_map(map)));
    run_ok(folder, {"export", "map.srbf", "--to", "exr", "-o", "map.exr"});
    Imf::InputFile file((folder / "map.exr").c_str(), 1);
    std::size_t channels = 0;
    for (auto layer = file.header().channels().begin(); layer != file.header().channels().end(); ++layer, ++channels)
        EXPECT_EQ(layer.channel().type, Imf::HALF);
    EXPECT_EQ(channels, 15u);
    std::vector<std::uint16_t> halves(map.count());
    for (std::size_t j = 0; j < 5; ++j)
        for (int c = 0; c < 3; ++c) {
            Imf::FrameBuffer frame;
            frame.insert(fmt::format("lobe{}.{}", j, "RGB"[c]),
                         {Imf::HALF, reinterpret_cast<char*>(halves.data()), 2, 2 * k_width});
            file.setFrameBuffer(frame);
            file.readPixels(0, k_height - 1);
            for (std::size_t t = 0; t < map.count(); ++t)
                EXPECT_EQ(from_half(halves[t]), map.coefficient[5 * t + j][c]);
        }
}

}  // namespace
}  // namespace srbf::map_exr_test
