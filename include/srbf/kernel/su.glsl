// Scattered univariate SRBFs. The host defines
//   Su                      a handle of a view-by-view model with the functions
//     su_lobes(su), su_views(su)             J, n                            [int]
//     su_direction(su, i)                    the direction of sampled view i (unit vector; z rises with i)
//     su_centre(su, i, j), su_bandwidth(su, i, j), su_coefficient(su, i, j)   xi_ij, lambda_ij, beta_ij (R, G, B)
//   SuNearest               a handle of the sampled views nearest to a direction with the function
//     su_nearest(nearest, k)                 index of the k-th nearest, from k = 0 on   [int]

// The function of sampled view i: sum_j beta_ij G(wl . xi_ij | lambda_ij) [1/sr], for R, G, B.
SRBF_FN Vec3 su_view_value(Su su, int view, Vec3 wl) {
    Vec3 sum = Vec3(Real(0.0), Real(0.0), Real(0.0));
    for (int j = 0; j < su_lobes(su); ++j)
        sum = sum + gaussian(wl, su_centre(su, view, j), Real(su_bandwidth(su, view, j))) * su_coefficient(su, view, j);
    return sum;
}

// The contribution of a sampled view to the value at another view direction: its weight, and the rotation about the
// normal that takes the view direction to the azimuth of the sampled view. wl is rotated by it too.
struct SuNeighbour {
    int view;
    Real weight;
    Real cosine;
    Real sine;
};

// Interpolation for isotropic BRDFs. Sampled views are rotated to the azimuth of wv, so that they differ only in
// elevation. The value is linear in wv.z between the two sampled views adjacent in elevation. Above the last
// sampled view the azimuth is ill-defined: over that cap the weight of this view falls linearly to 0 at the pole,
// and three copies of it, rotated by thirds of a circle, replace it. The interpolation is continuous in wv and
// exact at sampled views. k: 0..SU_ROTATED_NEIGHBOURS-1.
#define SU_ROTATED_NEIGHBOURS 5
SRBF_FN SuNeighbour su_rotated_neighbour(Su su, Vec3 wv, int k) {
    int last = su_views(su) - 1;
    Real position = max(wv.z * Real(su_views(su)) - Real(0.5), Real(0.0));  // the samples are uniform in z
    int below = position < Real(last) ? int(position) : last;
    int above = below < last ? below + 1 : last;
    Vec3 top = su_direction(su, last);
    Real radius = sqrt(wv.x * wv.x + wv.y * wv.y);
    Real top_radius = max(sqrt(top.x * top.x + top.y * top.y), Real(1.0e-20));
    Real cap = wv.z > top.z ? min(radius / top_radius, Real(1.0)) : Real(1.0);  // 1 outside the cap, 0 at the pole

    SuNeighbour neighbour;
    neighbour.view = k == 0 ? below : k == 1 ? above : last;
    Vec3 sample_ = su_direction(su, neighbour.view);
    Real from = su_direction(su, below).z;
    Real step = su_direction(su, above).z - from;
    Real part = step > Real(0.0) ? min(max((wv.z - from) / step, Real(0.0)), Real(1.0)) : Real(0.0);
    Real length = max(radius * sqrt(sample_.x * sample_.x + sample_.y * sample_.y), Real(1.0e-20));
    neighbour.weight = k == 0 ? cap * (Real(1.0) - part) : k == 1 ? cap * part : (Real(1.0) - cap) / Real(3.0);
    neighbour.cosine = k < 2 ? (wv.x * sample_.x + wv.y * sample_.y) / length : k == 2 ? Real(1.0) : Real(-0.5);
    neighbour.sine = k < 2 ? (wv.x * sample_.y - wv.y * sample_.x) / length
                           : Real(0.8660254037844386) * (k == 3 ? Real(1.0) : k == 4 ? Real(-1.0) : Real(0.0));
    return neighbour;
}

SRBF_FN Vec3 su_rotated_part(Su su, Vec3 wl, Vec3 wv, int k) {
    SuNeighbour neighbour = su_rotated_neighbour(su, wv, k);
    return neighbour.weight * su_view_value(su, neighbour.view, turned(wl, neighbour.cosine, neighbour.sine));
}

// Neighbours beyond the first two contribute only within the cap. (A loop may have no iterations where a branch is
// not allowed.)
SRBF_FN Vec3 su_rotated_value(Su su, Vec3 wl, Vec3 wv) {
    Vec3 sum = su_rotated_part(su, wl, wv, 0) + su_rotated_part(su, wl, wv, 1);
    int count = wv.z > su_direction(su, su_views(su) - 1).z ? SU_ROTATED_NEIGHBOURS : 2;
    for (int k = 2; k < count; ++k) sum = sum + su_rotated_part(su, wl, wv, k);
    return sum;
}

// Plain interpolation: the K nearest views, not rotated. The weight of a view at distance d from wv is 1/d - 1/d_K,
// where d_K is the distance of the next nearest view; weights are not yet normalised. A weight falls to 0 as its
// view leaves the K nearest, and dominates as wv approaches the view. It is at least 1e-5/d_K: if all K+1 views are
// equally far, the result is their mean instead of a quotient of rounding errors.
SRBF_FN Real su_plain_weight(Su su, SuNearest nearest, Vec3 wv, int neighbours, int k) {
    Vec3 apart = wv - su_direction(su, su_nearest(nearest, k));
    Vec3 leaving = wv - su_direction(su, su_nearest(nearest, neighbours));
    Real of_next = inversesqrt(max(dot(leaving, leaving), Real(1.0e-30)));
    return max(inversesqrt(max(dot(apart, apart), Real(1.0e-30))) - of_next, Real(1.0e-5) * of_next);
}

SRBF_FN Vec3 su_plain_value(Su su, SuNearest nearest, Vec3 wl, Vec3 wv, int neighbours) {
    Vec3 sum = Vec3(Real(0.0), Real(0.0), Real(0.0));
    Real weights = Real(0.0);
    for (int k = 0; k < neighbours; ++k) {
        Real weight = su_plain_weight(su, nearest, wv, neighbours, k);
        weights = weights + weight;
        sum = sum + weight * su_view_value(su, su_nearest(nearest, k), wl);
    }
    return (Real(1.0) / max(weights, Real(1.0e-20))) * sum;
}
