// The half vectors of another roughness. Beside kernel.glsl, for what edits models.

// A pair of directions.
struct DirectionPair {
    Vec3 l;
    Vec3 v;
};

// The pair about a half vector with 1 / factor times the slope of that of (wl, wv), and the same azimuth. Light and half
// vector are at the same angle, and as far as both are above the horizon, wl is at the same azimuth about the half vector.
SRBF_FN DirectionPair with_slope_over(Real factor, Vec3 wl, Vec3 wv) {
    Vec3 sum = wl + wv;
    Real length_of_sum = sqrt(max(dot(sum, sum), Real(1.0e-18)));
    Vec3 h = (Real(1.0) / length_of_sum) * sum;
    Vec3 d = Real(0.5) * (wl - wv);
    Real cosine = Real(0.5) * length_of_sum;
    Real tilt = sqrt(h.x * h.x + h.y * h.y);
    Real x = select(tilt > Real(1.0e-7), h.x / max(tilt, Real(1.0e-7)), Real(1.0));  // towards which h is tilted
    Real y = select(tilt > Real(1.0e-7), h.y / max(tilt, Real(1.0e-7)), Real(0.0));
    Real slope = tilt / (factor * max(h.z, Real(1.0e-9)));
    Real up = inversesqrt(Real(1.0) + slope * slope);
    Real steepness = slope * up;  // the sine of the new half vector
    // d along the steepest descent and across it: above the horizon remains a tenth of the cosine of an upright d.
    Real most = Real(0.9) * up * cosine / max(steepness, Real(1.0e-9));
    Real along = min(max(h.z * (d.x * x + d.y * y) - tilt * d.z, -most), most);
    Real rest = sqrt(max(dot(d, d) - along * along, Real(0.0)));
    Real side = d.y * x - d.x * y;
    Real across = select(side < Real(0.0), -rest, rest);
    Vec3 middle = cosine * Vec3(steepness * x, steepness * y, up);
    Vec3 apart = along * Vec3(up * x, up * y, -steepness) + across * Vec3(-y, x, Real(0.0));
    DirectionPair pair;
    pair.l = middle + apart;
    pair.v = middle - apart;
    return pair;
}
