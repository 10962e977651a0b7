// Small files of the measured formats, made in memory, and reference values for real ones.
#pragma once
#include <algorithm>
#include <fstream>
#include <functional>
#include <map>
#include <sstream>

#include "measured/formats/tensor_file.h"
#include "properties.h"
#include "srbf/measured.h"

namespace srbf {

using Bytes = std::vector<std::byte>;

template <typename T> void append(Bytes& bytes, const T& number) {
    const auto raw = std::as_bytes(std::span(&number, 1));
    bytes.insert(bytes.end(), raw.begin(), raw.end());
}

/// A MERL file of f(h, d, p, channel) [1/sr].
inline Bytes merl_file(std::array<int, 3> size, const std::function<double(int, int, int, int)>& f) {
    Bytes bytes;
    for (const int n : size) append(bytes, std::int32_t(n));
    const double scale[3] = {1 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0};
    for (int c = 0; c < 3; ++c)
        for (int h = 0; h < size[0]; ++h)
            for (int d = 0; d < size[1]; ++d)
                for (int p = 0; p < size[2]; ++p) append(bytes, f(h, d, p, c) / scale[c]);
    return bytes;
}

/// A field of a tensor file, with its numbers as bytes.
struct FieldToWrite {
    std::string name;
    TensorType type;
    std::vector<std::uint64_t> shape;
    Bytes numbers;
};

inline FieldToWrite float_field(std::string name, std::vector<std::uint64_t> shape,
                                const std::function<float(std::size_t)>& f) {
    std::size_t count = 1;
    for (const auto extent : shape) count *= extent;
    Bytes numbers;
    for (std::size_t i = 0; i < count; ++i) append(numbers, f(i));
    return {std::move(name), TensorType::f32, std::move(shape), std::move(numbers)};
}

/// A tensor file; `header` receives the bytes before the numbers.
inline Bytes tensor_file(const std::vector<FieldToWrite>& fields, std::size_t* header = nullptr) {
    std::uint64_t offset = k_tensor_magic.size() + 6;
    for (const auto& field : fields) offset += 13 + field.name.size() + 8 * field.shape.size();
    if (header) *header = offset;
    Bytes bytes;
    for (const char c : k_tensor_magic) append(bytes, c);
    append(bytes, std::uint8_t(1));
    append(bytes, std::uint8_t(0));
    append(bytes, std::uint32_t(fields.size()));
    for (const auto& field : fields) {
        append(bytes, std::uint16_t(field.name.size()));
        for (const char c : field.name) append(bytes, c);
        append(bytes, std::uint16_t(field.shape.size()));
        append(bytes, field.type);
        append(bytes, offset);
        for (const auto extent : field.shape) append(bytes, extent);
        offset += field.numbers.size();
    }
    for (const auto& field : fields) bytes.insert(bytes.end(), field.numbers.begin(), field.numbers.end());
    return bytes;
}

/// The fields of an isotropic RGL measurement whose warp is the identity, with ndf(u) = 1 + u, sigma(u) = 1 −
/// u/2, and the colour at w: (w_x, w_y, w_x − ½).
inline std::vector<FieldToWrite> simple_rgl() {
    const std::vector<float> theta{0, 0.7f, 1.55f};
    FieldToWrite description{"description", TensorType::u8, {4}, {}}, jacobian{"jacobian", TensorType::u8, {1}, {}};
    for (const char c : std::string("test")) append(description.numbers, c);
    append(jacobian.numbers, std::uint8_t(1));
    return {description,
            jacobian,
            float_field("phi_i", {1}, [](std::size_t) { return 0.0f; }),
            float_field("theta_i", {3}, [&](std::size_t i) { return theta[i]; }),
            float_field("ndf", {2, 4}, [](std::size_t i) { return 1 + float(i % 4) / 3; }),
            float_field("sigma", {2, 5}, [](std::size_t i) { return 1 - float(i % 5) / 8; }),
            float_field("vndf", {1, 3, 4, 5}, [](std::size_t) { return 0.1f; }),
            float_field("rgb", {1, 3, 3, 4, 3}, [](std::size_t i) {
                const float x = float(i % 3) / 2, y = float(i / 3 % 4) / 3;
                return i / 12 % 3 == 0 ? x : i / 12 % 3 == 1 ? y : x - 0.5f;
            })};
}

inline FieldToWrite& field(std::vector<FieldToWrite>& fields, const std::string& name) {
    for (auto& f : fields)
        if (f.name == name) return f;
    throw std::out_of_range(name);
}

/// Returns the same fields with spectra at three wavelengths, not colours. The spectrum at w is (w_x, w_y, w_x − ½).
inline std::vector<FieldToWrite> spectral_rgl() {
    auto fields = simple_rgl();
    field(fields, "rgb").name = "spectra";
    const float nm[] = {450, 550, 600};
    fields.push_back(float_field("wavelengths", {3}, [&](std::size_t i) { return nm[i]; }));
    return fields;
}

/// An anisotropic measurement with the identity as warp, over azimuths −π .. −π + 2π/symmetry in four steps: ndf(u, t)
/// = 1 + u + t, sigma(u, t) = 1 − u/2 + t/4, and the colour at w and slice (i, j) of φ_l and θ_l: (w_x, w_y, 1 + i/2 +
/// j).
inline std::vector<FieldToWrite> anisotropic_rgl(int symmetry = 1) {
    auto fields = simple_rgl();
    const auto replace = [&](const char* name, std::vector<std::uint64_t> shape, auto f) {
        field(fields, name) = float_field(name, std::move(shape), f);
    };
    replace("phi_i", {5}, [&](std::size_t i) { return float(-k_pi + 2 * k_pi / symmetry * double(i) / 4); });
    replace("ndf", {3, 4}, [](std::size_t i) { return 1 + float(i % 4) / 3 + float(i / 4) / 2; });
    replace("sigma", {3, 5}, [](std::size_t i) { return 1 - float(i % 5) / 8 + float(i / 5) / 8; });
    replace("vndf", {5, 3, 4, 5}, [](std::size_t) { return 0.1f; });
    replace("rgb", {5, 3, 3, 4, 3}, [](std::size_t i) {
        const std::size_t channel = i / 12 % 3, slice = i / 36;
        return channel == 0   ? float(i % 3) / 2
               : channel == 1 ? float(i / 3 % 4) / 3
                              : 1 + float(slice / 3) / 2 + float(slice % 3);
    });
    return fields;
}

/// A UTIA file of f(i_θl, i_φl, i_θv, i_φv, channel) [1/sr].
inline Bytes utia_file(const std::function<double(int, int, int, int, int)>& f) {
    Bytes bytes;
    bytes.reserve(3 * 288 * 288 * sizeof(double));
    for (int c = 0; c < 3; ++c)
        for (int l = 0; l < 288; ++l)
            for (int v = 0; v < 288; ++v) append(bytes, f(l / 48, l % 48, v / 48, v % 48, c));
    return bytes;
}

/// A block of an MBSDF file with f(i, j, k, channel) [1/sr].
inline Bytes mbsdf_block(const std::string& head, std::uint32_t polar, std::uint32_t azimuths, int channels,
                         const std::function<double(int, int, int, int)>& f) {
    Bytes bytes;
    for (const char c : head + "\n") append(bytes, c);
    append(bytes, std::uint32_t(channels == 3));
    append(bytes, polar);
    append(bytes, azimuths);
    for (int i = 0; i < int(polar); ++i)
        for (int j = 0; j < int(polar); ++j)
            for (int k = 0; k < int(azimuths); ++k)
                for (int c = 0; c < channels; ++c) append(bytes, float(f(i, j, k, c)));
    return bytes;
}

/// An MBSDF file with these lines of metadata and these blocks.
inline Bytes mbsdf_file(const std::string& lines, const std::vector<Bytes>& blocks) {
    Bytes bytes;
    for (const char c : "NVIDIA ARC MBSDF V1\n" + lines) append(bytes, c);
    for (const Bytes& block : blocks) bytes.insert(bytes.end(), block.begin(), block.end());
    return bytes;
}

/// Small MBSDF files. One has colours, some of them negative; the other is grey and has transmission.
inline Bytes small_mbsdf() {
    return mbsdf_file("material=\"blue \\\"paint\\\"\"\n",
                      {mbsdf_block("MBSDF_DATA_REFLECTION=", 3, 4, 3,
                                   [](int i, int j, int k, int c) { return 0.25 * (i + 2 * j) - 0.125 * k * c; })});
}
inline Bytes grey_mbsdf() {
    const auto f = [](int i, int j, int k, int) { return 0.25 * (i + 2 * j + 3 * k); };
    return mbsdf_file("",
                      {mbsdf_block("MBSDF_DATA=", 2, 3, 1, f), mbsdf_block("MBSDF_DATA_TRANSMISSION=", 1, 2, 3, f)});
}

/// A measurement of this table, without names.
inline Measured measured_of(decltype(Measured::table) table) { return {{}, {}, 0, std::move(table)}; }

/// A measurement bundled with the project, by its name without extension. Each is read once.
inline const Measured& bundled(const std::string& name) {
    static std::map<std::string, Measured> all;
    const auto [entry, is_new] = all.try_emplace(name);
    if (is_new) entry->second = *load_measured((bundled_data() / (name + ".bsdf")).string());
    return entry->second;
}

/// Small files of the text formats.
inline constexpr std::string_view k_small_cornell =
    "# Blue paint\r\n\r\n# num wls\r\n3\r\n# wls\r\n450 550\r\n650\r\n"
    "0.1 0.0 0.2 3.0 0.30 0.20 0.10 # a comment\r\n0.5 0.0 1.0 0.5 0.31 0.21 0.11\r\n1.2 0.0 1.2 3.14 3 2 1\r\n";
inline constexpr std::string_view k_small_astm =
    "# Blue paint\n\nLAB_NAME A laboratory\nSAMPLE_NAME Blue\nNUM_POINTS 3\nVARS theta_i,phi_i,theta_s,phi_s,R,G,B\n\n"
    "0.1,0.0,0.2,3.0,0.10,0.20,0.30\n0.5,0.0,1.0,0.5,-0.01,0.21,0.31\n1.2,0.0,1.2,3.14,1,2,3\n";
inline constexpr std::string_view k_small_alta =
    "#SAMPLE \"Tape\"\n#DIM 3 1\n#VS 1\n#PARAM_IN ISOTROPIC_TL_TV_PROJ_DPHI\n#PARAM_OUT INV_STERADIAN\n"
    "0.1 0.2 0.3 0.5 0.01\n0.5 -0.5 0.1 0.25 0.01\n1.0 0.7 -0.7 2.5 0.1\n";
inline constexpr std::string_view k_small_csv =
    "# isotropic\ntheta_l_deg, phi_l_deg, theta_v_deg, phi_v_deg, r, g, b, note\n"
    "10,0,20,180,0.1,0.2,0.3,\"a, b\"\n30,5,60,5,0.11,nan,0.31,\n70,90,70,270,1,2,3,\n0,0,80,20,+0.4,.5,5e-1,x\n";

/// A row of reference values.
struct Reference {
    Vec3f wl, wv;
    Rgb f;
};

inline std::vector<Reference> read_reference(const std::filesystem::path& path) {
    std::ifstream in(path);
    std::string line;
    std::getline(in, line);  // the names of the columns
    std::vector<Reference> rows;
    while (std::getline(in, line)) {
        std::ranges::replace(line, ',', ' ');
        Reference r;
        std::istringstream(line) >> r.wl.x >> r.wl.y >> r.wl.z >> r.wv.x >> r.wv.y >> r.wv.z >> r.f.r >> r.f.g >> r.f.b;
        rows.push_back(r);
    }
    return rows;
}

}  // namespace srbf
