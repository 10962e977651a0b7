// path_tracer MODEL PICTURE.ppm [SAMPLES]: a sphere of a model (.srbf) on a chequered floor of the same model, under a
// sky with a sun, by paths with multiple importance sampling. It is compiled by: cc -O2 path_tracer.c -lm
#define SRBF_RUNTIME_IMPLEMENTATION
#include "srbf_runtime.h"

#include <stdio.h>
#include <stdlib.h>

enum { k_width = 320, k_height = 240, k_depth = 6 };
static const double k_pi = 3.14159265358979, k_cosine = 0.985, k_bright = 25;
static const double k_sun[3] = {0.48, 0.6, 0.64};

static double dot(const double* a, const double* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
static double uniform(void) {
    static unsigned long long state = 1;
    state = state * 6364136223846793005ull + 1442695040888963407ull;
    return (double)(state >> 40) / (double)(1 << 24);
}
// Sets two tangents of a unit normal, which is the third row.
static void make_frame(double frame[3][3]) {
    const double *n = frame[2], s = n[2] < 0 ? -1 : 1, a = -1 / (s + n[2]), b = n[0] * n[1] * a;
    const double tangents[2][3] = {{1 + s * n[0] * n[0] * a, s * b, -s * n[0]}, {b, s + n[1] * n[1] * a, -n[1]}};
    memcpy(frame, tangents, sizeof tangents);
}
static void to_local(double frame[3][3], const double* w, float* local) {
    for (int i = 0; i < 3; ++i) local[i] = (float)dot(frame[i], w);
}
static void to_world(double frame[3][3], const float* w, double* world) {
    for (int i = 0; i < 3; ++i)
        world[i] = frame[0][i] * (double)w[0] + frame[1][i] * (double)w[1] + frame[2][i] * (double)w[2];
}
// The distance to the sphere about (0, 0, 1) or to the floor, with the normal there; 0 if there is none.
static double intersect(const double* from, const double* w, double* normal) {
    const double from_centre[3] = {from[0], from[1], from[2] - 1}, b = dot(from_centre, w),
                 root = b * b - dot(from_centre, from_centre) + 1;
    const double near = -b - sqrt(fmax(root, 0)), distance = near > 1e-4 ? near : 2 * -b - near;
    const double floor_distance = w[2] != 0 ? -from[2] / w[2] : 0;
    const int hits = root > 0 && distance > 1e-4, hits_floor = floor_distance > 1e-4;
    const int is_floor = hits_floor && (!hits || floor_distance < distance);
    for (int i = 0; i < 3; ++i) normal[i] = is_floor ? i == 2 : from_centre[i] + distance * w[i];
    if (is_floor) return floor_distance;
    return hits ? distance : 0;
}

// The radiance of the sky; the density of directions that sample the sun is 1 / its solid angle.
static double sky(const double* w, int channel) { return 0.35 + (channel == 2 ? 0.5 : 0.25) * fmax(w[2], 0); }
static double sun_pdf(const double* w) { return dot(w, k_sun) > k_cosine ? 1 / (2 * k_pi * (1 - k_cosine)) : 0; }

static void trace(const srbf_brdf* brdf, double* at, double* ray, double* radiance) {
    double throughput[3] = {1, 1, 1}, sun_fraction = 1;  // `sun_fraction`: how much of the sun's light the ray counts
    for (int depth = 0; depth < k_depth; ++depth) {
        double frame[3][3], sun[3][3], w[3], normal[3], back[3];
        const double distance = intersect(at, ray, frame[2]);
        for (int c = 0; c < 3 && distance == 0; ++c)
            radiance[c] += throughput[c] * (sky(ray, c) + (sun_pdf(ray) > 0 ? k_bright * sun_fraction : 0));
        if (distance == 0) return;
        for (int i = 0; i < 3; ++i) at[i] += distance * ray[i], back[i] = -ray[i];
        if (fabs(at[2]) < 1e-6 && (((int)floor(2 * at[0]) + (int)floor(2 * at[1])) & 1))
            for (int c = 0; c < 3; ++c) throughput[c] *= 0.3;  // a dark square
        memcpy(sun[2], k_sun, sizeof k_sun);
        make_frame(sun);
        make_frame(frame);
        float wv[3], wl[3], f[3], u[3];
        const double z = 1 - uniform() * (1 - k_cosine), r = sqrt(1 - z * z), phi = 2 * k_pi * uniform();
        const float cone[3] = {(float)(r * cos(phi)), (float)(r * sin(phi)), (float)z};
        to_world(sun, cone, w);
        to_local(frame, back, wv);
        to_local(frame, w, wl);
        const double pdf = (double)srbf_value_pdf(brdf, wl, wv, f);
        if (intersect(at, w, normal) == 0)
            for (int c = 0; c < 3; ++c)
                radiance[c] += throughput[c] * (double)f[c] * fabs((double)wl[2]) * k_bright / (sun_pdf(k_sun) + pdf);
        srbf_light light;
        u[0] = (float)uniform(), u[1] = (float)uniform(), u[2] = (float)uniform();
        srbf_sample(brdf, wv, u, &light);
        if (!(light.pdf > 0) && !light.is_beam) return;
        to_world(frame, light.wl, ray);
        sun_fraction = light.is_beam ? 1 : (double)light.pdf / ((double)light.pdf + sun_pdf(ray));
        for (int c = 0; c < 3; ++c) throughput[c] *= (double)light.weight[c];
    }
}
static unsigned char model[1 << 22], memory[1 << 24];
int main(int count, char** arguments) {
    FILE *file = count > 2 ? fopen(arguments[1], "rb") : 0, *picture = 0;
    const int samples = count > 3 ? atoi(arguments[3]) : 64;
    const size_t size = file ? fread(model, 1, sizeof model, file) : 0;
    srbf_brdf* brdf;
    if (samples > 0 && srbf_open(model, size, memory, sizeof memory, &brdf, 0) == SRBF_OK)
        picture = fopen(arguments[2], "wb");
    if (!picture)
        return fprintf(stderr, "usage: path_tracer MODEL PICTURE.ppm [SAMPLES], of a model that can be read\n"), 1;
    srbf_prepare(brdf);
    fprintf(picture, "P6\n%d %d\n255\n", k_width, k_height);
    for (int pixel = 0; pixel < k_width * k_height; ++pixel) {
        double radiance[3] = {0, 0, 0};
        for (int i = 0; i < samples; ++i) {
            const double x = (pixel % k_width + uniform()) / k_width - 0.5;
            const double z = 0.225 - (pixel / k_width + uniform()) / k_width, length = sqrt(x * x + 1 + z * z);
            double at[3] = {0, -4.2, 1.5}, ray[3] = {x / length, 1 / length, z / length};
            trace(brdf, at, ray, radiance);
        }
        for (int c = 0; c < 3; ++c) fputc((int)(255 * pow(fmin(radiance[c] / samples, 1), 1 / 2.2) + 0.5), picture);
    }
    return fclose(picture) != 0;
}
