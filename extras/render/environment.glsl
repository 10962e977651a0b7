// An environment map as in render/environment.h: radiance and importance sampling. Must follow a material's text.
uniform sampler2D environment;          // radiance / environment_scale, with mip levels
uniform sampler2D environment_columns;  // running sums of the light along each row, from 0 to 1: width + 1 numbers
uniform sampler2D environment_rows;     // running sums over the rows: height + 1 numbers
uniform float environment_scale;
uniform mat3 into_environment;  // from the world to the axes of the map

const float k_pi_ = 3.141592653589793;

ivec2 environment_size() { return textureSize(environment, 0); }

// The position of a direction on the map, from 0 to 1. The row uses an arc tangent, which is more accurate near the
// poles than an arc cosine.
vec2 environment_place(Vec3 towards) {
    Vec3 w = into_environment * towards;
    return vec2(0.5 + atan(w.x, -w.z) / (2.0 * k_pi_), atan(length(w.xz), w.y) / k_pi_);
}
Vec3 environment_radiance(vec2 place, float level) {
    return environment_scale * textureLod(environment, place, level).rgb;
}
// The solid angle of a texel [sr].
float texel_solid_angle(float row, vec2 size) {
    return 4.0 * k_pi_ / size.x * sin(k_pi_ * (row + 0.5) / size.y) * sin(0.5 * k_pi_ / size.y);
}

float running_sum(sampler2D sums, int column, int row) { return texelFetch(sums, ivec2(column, row), 0).r; }
// The density of sample_environment in a texel [1/sr].
float environment_texel_pdf(ivec2 texel) {
    float row_probability = running_sum(environment_rows, texel.y + 1, 0) - running_sum(environment_rows, texel.y, 0);
    float texel_probability =
        running_sum(environment_columns, texel.x + 1, texel.y) - running_sum(environment_columns, texel.x, texel.y);
    return row_probability * texel_probability / texel_solid_angle(float(texel.y), vec2(environment_size()));
}
float environment_pdf(vec2 place) {
    ivec2 size = environment_size();
    return environment_texel_pdf(clamp(ivec2(place * vec2(size)), ivec2(0), size - 1));
}

// The interval of `count` running sums that contains u, and the position of u within it, from 0 to 1.
struct Interval {
    int index;
    float within;
};
Interval interval_of(sampler2D sums, int row, int count, float u) {
    int low = 0;
    int high = count;
    while (high - low > 1) {
        int middle = (low + high) / 2;
        if (running_sum(sums, middle, row) <= u)
            low = middle;
        else
            high = middle;
    }
    float first = running_sum(sums, low, row);
    return Interval(low, clamp((u - first) / max(running_sum(sums, high, row) - first, 1.0e-30), 0.0, 1.0));
}

// A direction in the world, for u1 and u2 uniform in [0,1), with its radiance and density [1/sr].
struct EnvironmentSample {
    Vec3 towards;
    Vec3 radiance;
    float pdf;
};
EnvironmentSample sample_environment(float u1, float u2) {
    ivec2 size = environment_size();
    Interval row = interval_of(environment_rows, 0, size.y, u2);
    Interval column = interval_of(environment_columns, row.index, size.x, u1);
    // Uniform in the solid angle of a texel: in cos(theta) and phi.
    float top = k_pi_ * float(row.index) / float(size.y);
    float sine_of_half = sin(0.5 * k_pi_ / float(size.y));
    // cos(top) - cos(theta)
    float below = 2.0 * row.within * sin(top + 0.5 * k_pi_ / float(size.y)) * sine_of_half;
    float cosine = cos(top) - below;
    float sine = sqrt(max(1.0 - cosine * cosine, 0.0));
    float phi = 2.0 * k_pi_ * ((float(column.index) + column.within) / float(size.x) - 0.5);
    EnvironmentSample drawn;
    Vec3 w = Vec3(sine * sin(phi), cosine, -sine * cos(phi));
    drawn.towards = w * into_environment;
    drawn.radiance = environment_radiance(environment_place(drawn.towards), 0.0);
    drawn.pdf = environment_texel_pdf(ivec2(column.index, row.index));
    return drawn;
}

// The level of the map at which the height of a texel is that of a square with this solid angle [sr]. If its width
// were used, it would include all directions around a nearby pole.
float environment_level(float solid_angle) {
    float height = k_pi_ / float(environment_size().y);
    return 0.5 * log2(max(solid_angle / (height * height), 1.0));
}
