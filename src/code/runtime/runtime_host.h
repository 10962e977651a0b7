// ---- Models, and their numbers as the formulas read them ----

// A view-by-view model: for each view its direction, and for each of its lobes R, G, B, bandwidth and centre.
typedef struct {
    int views, lobes, of_lights, is_plain, neighbours;
    const float* number;
} srbf_view_lobes;
typedef const srbf_view_lobes* srbf_su;
typedef const int* srbf_su_nearest_views;
SRBF_FN int srbf_su_lobes(srbf_su su) { return su->lobes; }
SRBF_FN int srbf_su_views(srbf_su su) { return su->views; }
SRBF_FN const float* srbf_su_row(srbf_su su, int view) {
    return su->number + (size_t)view * (size_t)(3 + 7 * su->lobes);
}
SRBF_FN srbf_vec3 srbf_vec3_at(const float* w) { return srbf_vec3_of(w[0], w[1], w[2]); }
SRBF_FN srbf_vec3 srbf_su_direction(srbf_su su, int view) { return srbf_vec3_at(srbf_su_row(su, view)); }
SRBF_FN const float* srbf_su_lobe(srbf_su su, int view, int j) { return srbf_su_row(su, view) + 3 + 7 * j; }
SRBF_FN srbf_vec3 srbf_su_coefficient(srbf_su su, int view, int j) { return srbf_vec3_at(srbf_su_lobe(su, view, j)); }
SRBF_FN float srbf_su_bandwidth(srbf_su su, int view, int j) { return srbf_su_lobe(su, view, j)[3]; }
SRBF_FN srbf_vec3 srbf_su_centre(srbf_su su, int view, int j) { return srbf_vec3_at(srbf_su_lobe(su, view, j) + 4); }
SRBF_FN int srbf_su_nearest(srbf_su_nearest_views nearest, int k) { return nearest[k]; }
