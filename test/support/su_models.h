// View-by-view models for tests.
#pragma once
#include "properties.h"
#include "srbf/models/su.h"

namespace srbf {

/// A model with n views and independent random lobes for each view, of bandwidths from 1 to 300.
inline SuModel random_su(std::mt19937_64& random, int views, int lobes) {
    SuModel model;
    model.lobes = lobes;
    model.direction = fibonacci_directions(views, k_pi / 2);
    for (int i = 0; i < views * lobes; ++i) {
        model.coefficient.push_back({float(uniform(random)), float(uniform(random)), float(uniform(random))});
        model.centre.push_back(to_float(random_direction(random)));
        model.bandwidth.push_back(float(elementary::pow(300, uniform(random))));
    }
    return model;
}

/// A model invariant under rotation of its views: the lobes of a view are the lobes of azimuth 0, rotated to its
/// azimuth, and vary linearly with its elevation.
inline SuModel isotropic_su(int views) {
    SuModel model;
    model.lobes = 2;
    model.direction = fibonacci_directions(views, k_pi / 2);
    for (const Vec3f& wv : model.direction) {
        model.coefficient.push_back({0.3f, 0.2f, 0.1f});
        model.centre.push_back({0, 0, 1});
        model.bandwidth.push_back(0.5f + wv.z);
        model.coefficient.push_back({1, 1.5f, 2 - wv.z});
        model.centre.push_back(mirror(wv));
        model.bandwidth.push_back(100);
    }
    return model;
}

}  // namespace srbf
