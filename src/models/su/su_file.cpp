#include "models/su/su_kind.h"

#include <fmt/format.h>

#include "base/half.h"
#include "brdf/directions.h"
#include "brdf/values.h"
#include "models/su/su_functions.h"

namespace SRBF_NAMESPACE {
namespace {

// A centre is stored by its angles relative to the mirror direction of its view. Near the highlight these are small,
// and so are their rounding errors.
Angles<float> to_relative(Vec3f centre, Vec3f view) {
    const Angles<float> a = angles(centre), origin = angles(mirror(view));
    return {a.theta - origin.theta, std::remainder(a.phi - origin.phi, float(2 * k_pi))};
}
Vec3f to_absolute(Angles<float> relative, Vec3f view) {
    const Angles<float> origin = angles(mirror(view));
    return spherical(relative.theta + origin.theta, relative.phi + origin.phi);
}

using Shape = std::vector<std::uint64_t>;

Tensor16 direction_table(const std::vector<Vec3f>& directions) {
    Tensor16 table{Type16::half, {directions.size(), 4}, {}};
    for (const Vec3f& w : directions)
        for (const float x : {w.x, w.y, w.z, 0.f}) table.data.push_back(to_half(x));
    return table;
}

/// A texture of nearest views without texels, by the shape of its tensor; no value if the shape is invalid.
std::optional<IndexTexture> texture_of(const Shape& shape) {
    const bool is_cube = shape.size() == 4;
    const std::uint64_t size = shape.size() >= 3 ? shape[shape.size() - 2] : 0;
    if (size == 0 || size > k_largest_texture) return {};
    if (shape != (is_cube ? Shape{6, size, size, 8} : Shape{size, size, 8})) return {};
    return IndexTexture{is_cube ? DirectionMap::cube : DirectionMap::parabolic, int(size), {}};
}

/// Decodes the numbers of the lobes; the model's directions and number of lobes are known.
Result<Done> decode_lobes(const std::map<std::string, Tensor16>& tensors, SuModel& model,
                          const std::string& file_name) {
    const auto J = std::size_t(model.lobes);
    const auto number = [&](const char* name) {
        return [&data = tensors.at(name).data](std::size_t i) { return from_half(data[i]); };
    };
    const auto coefficient = number("coefficient"), bandwidth = number("bandwidth"), centre = number("centre");
    for (std::size_t i = 0; i < model.direction.size() * J; ++i) {
        const Rgb beta{coefficient(3 * i), coefficient(3 * i + 1), coefficient(3 * i + 2)};
        for (const auto& [what, x] : {std::pair("tensor 'coefficient'", std::min({beta.r, beta.g, beta.b})),
                                      {"tensor 'bandwidth'", bandwidth(i)}})
            if (x < 0) return Error{file_name, {}, what, "numbers of at least 0", fmt::format("{}", x)};
        model.coefficient.push_back(beta);
        model.bandwidth.push_back(bandwidth(i));
        model.centre.push_back(to_absolute({centre(2 * i), centre(2 * i + 1)}, model.direction[i / J]));
    }
    return Done{};
}

}  // namespace

Safetensors Kind<SuModel>::content(const SuModel& model) {
    const auto n = std::uint64_t(model.direction.size()), J = std::uint64_t(model.lobes);
    Safetensors content{{},
                        {{"discretise", std::string(srbf::name(model.discretise))},
                         {"interpolation", std::string(srbf::name(model.interpolation))},
                         {"neighbours", std::to_string(model.neighbours)}}};
    auto& tensors = content.tensors;
    Tensor16& coefficient = tensors["coefficient"] = {Type16::half, {n, J, 3}, {}};
    for (const Rgb& beta : model.coefficient)
        for (int c = 0; c < 3; ++c) coefficient.data.push_back(to_half(std::min(beta[c], k_half_max)));
    Tensor16& bandwidth = tensors["bandwidth"] = {Type16::half, {n, J}, {}};
    for (const float lambda : model.bandwidth) bandwidth.data.push_back(to_half(std::min(lambda, k_half_max)));
    Tensor16& centre = tensors["centre"] = {Type16::half, {n, J, 2}, {}};
    for (std::size_t i = 0; i < model.centre.size(); ++i) {
        const Angles<float> relative = to_relative(model.centre[i], model.direction[i / J]);
        centre.data.push_back(to_half(relative.theta));
        centre.data.push_back(to_half(relative.phi));
    }
    if (model.index) {
        const auto size = std::uint64_t(model.index->size);
        Tensor16& index = tensors["aux.index"] = {Type16::count, {size, size, 8}, {}};
        if (model.index->map == DirectionMap::cube) index.shape.insert(index.shape.begin(), 6);
        for (const NearestViews& nearest : model.index->texels)
            index.data.insert(index.data.end(), nearest.begin(), nearest.end());
        tensors["aux.directions"] = direction_table(model.direction);
    }
    return content;
}

Result<SuModel> Kind<SuModel>::read(Safetensors& content, const std::string& file_name) {
    MetadataReader reader{content.metadata, file_name};
    const auto discretise = reader.take("discretise", {srbf::name(Discretise::view), srbf::name(Discretise::light)});
    const auto interpolation =
        reader.take("interpolation", {srbf::name(SuInterpolation::rotated), srbf::name(SuInterpolation::plain)});
    const auto neighbours = reader.take("neighbours", {"1", "2", "3", "4", "5", "6", "7"});
    if (reader.error) return *reader.error;
    const auto& tensors = content.tensors;
    const auto fail = [&](std::string what, std::string expected, std::string found) {
        return Error{file_name, std::nullopt, std::move(what), std::move(expected), std::move(found)};
    };
    const auto extent = shape_of_bandwidths(
        tensors, {k_min_views, 0}, {k_max_views, k_max_view_lobes},
        fmt::format("[n, J] from [{}, 1] to [{}, {}]", k_min_views, k_max_views, k_max_view_lobes), file_name);
    if (!extent) return extent.error();
    const std::uint64_t n = (*extent)[0], J = (*extent)[1];

    std::map<std::string, TensorShape> expected{{"coefficient", {Type16::half, {n, J, 3}}},
                                                {"bandwidth", {Type16::half, {n, J}}},
                                                {"centre", {Type16::half, {n, J, 2}}}};
    if (tensors.contains("shape"))
        return fail("tensor 'shape'", "Gaussian lobes alone", "shapes of lobes, which a new fit does without");
    SuModel model;
    const auto index = tensors.find("aux.index");
    const bool has_index = index != tensors.end();
    if (has_index) {
        const Shape& shape = index->second.shape;
        model.index = texture_of(shape);
        if (!model.index)
            return fail("tensor 'aux.index': shape",
                        fmt::format("[6, s, s, 8] or [s, s, 8], s up to {}", k_largest_texture), shape_text(shape));
        expected["aux.index"] = {Type16::count, shape};
    }
    if (has_index || tensors.contains("aux.directions")) expected["aux.directions"] = {Type16::half, {n, 4}};
    if (const auto valid = check_tensors(tensors, expected, file_name); !valid) return valid.error();

    model.discretise = *discretise_named(discretise);
    model.interpolation = *interpolation_named(interpolation);
    model.neighbours = neighbours[0] - '0';
    model.lobes = int(J);
    model.direction = fibonacci_directions(int(n), k_pi / 2);
    if (const auto lobes = decode_lobes(tensors, model, file_name); !lobes) return lobes.error();
    if (tensors.contains("aux.directions") &&
        tensors.at("aux.directions").data != direction_table(model.direction).data)
        return fail("tensor 'aux.directions'", fmt::format("the Fibonacci set of {}", n), "other directions");
    if (has_index) {
        const auto& data = index->second.data;
        const auto out_of_range = std::find_if(data.begin(), data.end(), [&](std::uint16_t view) { return view >= n; });
        if (out_of_range != data.end())
            return fail("tensor 'aux.index'", fmt::format("numbers below {}", n), fmt::format("{}", *out_of_range));
        model.index->texels.resize(data.size() / 8);
        for (std::size_t i = 0; i < data.size(); ++i) model.index->texels[i / 8][i % 8] = data[i];
    }
    return model;
}

double Kind<SuModel>::largest(const SuModel& model) {
    double largest = 0;
    for (const Rgb& beta : model.coefficient) largest = std::max(largest, largest_of(beta));
    return largest;
}

}  // namespace
