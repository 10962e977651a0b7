// A sphere of a measured material under a lamp, in C: cc -O2 sphere.c -lm && ./a.out > PICTURE
// Beside this file: what `srbf export material.srbf --to c -o material.h` writes. PICTURE is float32 of linear R, G, B.
#include <stdio.h>

#include "material.h"

static srbf_vec3 vec3(float x, float y, float z) { return (srbf_vec3){x, y, z}; }
static float dot(srbf_vec3 a, srbf_vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static srbf_vec3 scaled(srbf_vec3 a, float by) { return vec3(by * a.x, by * a.y, by * a.z); }
static srbf_vec3 unit(srbf_vec3 a) { return scaled(a, 1 / sqrtf(dot(a, a))); }
static srbf_vec3 cross(srbf_vec3 a, srbf_vec3 b) {
    return vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

int main(void) {
    enum { k_size = 256 };
    const float reach = tanf(13 * 3.14159265f / 180), distance = 5, irradiance = 3;
    const srbf_vec3 light = unit(vec3(-2, 2, 3));
    for (int i = 0; i < k_size * k_size; ++i) {
        const float x = (float)(i % k_size) + 0.5f, y = (float)(i / k_size) + 0.5f;
        const srbf_vec3 ray = unit(vec3(reach * (2 * x / k_size - 1), reach * (1 - 2 * y / k_size), -1));
        const float along = -distance * ray.z, squared = along * along - distance * distance + 1;
        srbf_vec3 pixel = vec3(0, 0, 0);
        if (squared > 0) {
            const srbf_vec3 hit = scaled(ray, along - sqrtf(squared)), n = vec3(hit.x, hit.y, hit.z + distance);
            const srbf_vec3 t = unit(cross(vec3(0, 1, 0), n)), b = cross(n, t);
            const srbf_vec3 wl = vec3(dot(t, light), dot(b, light), dot(n, light));
            const srbf_vec3 wv = vec3(-dot(t, ray), -dot(b, ray), -dot(n, ray));
            pixel = scaled(material_brdf(wl, wv), irradiance * fmaxf(wl.z, 0));
        }
        fwrite(&pixel, sizeof pixel, 1, stdout);
    }
}
