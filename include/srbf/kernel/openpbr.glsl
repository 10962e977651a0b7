// Surfaces with the parameters of renderers.

// The product of two colours, and linear interpolation a + t (b - a).
SRBF_FN Vec3 product_of(Vec3 a, Vec3 b) { return Vec3(a.x * b.x, a.y * b.y, a.z * b.z); }
SRBF_FN Vec3 interpolated(Vec3 a, Vec3 b, Real t) { return (Real(1.0) - t) * a + t * b; }

// The polynomial a + b y + c y^2, and x clamped to [0, 1].
SRBF_FN Real polynomial(Real y, Real a, Real b, Real c) { return a + y * (b + y * c); }
SRBF_FN Real clamped_to_unit(Real x) { return min(max(x, Real(0.0)), Real(1.0)); }

// The reflectance of an interface for unpolarised light that arrives from outside at an angle of cosine c, and at c
// = 1. The medium has the relative index of refraction ior >= 1 (Fresnel's equations, in the form of Cook &
// Torrance 1982).
SRBF_FN Real dielectric_reflectance(Real c, Real ior) {
    Real g = sqrt(max(ior * ior - Real(1.0) + c * c, Real(1.0e-12)));
    Real across = (g - c) / (g + c);
    Real turn = (c * (g + c) - Real(1.0)) / (c * (g - c) + Real(1.0));
    return Real(0.5) * (across * across) * (Real(1.0) + turn * turn);
}
SRBF_FN Real normal_reflectance(Real ior) {
    Real share = (ior - Real(1.0)) / (ior + Real(1.0));
    return share * share;
}

// The directional albedo of GGX facets with Schlick's Fresnel term, F0 scale + F90 bias, at cosine x to the normal
// and with roughness alpha = y. These are the rational functions of MaterialX 1.38. For y >= 0.01 their sum differs
// from the integral by less than 0.02 if x >= 0.5, and by less than 0.03 if x >= 0.2.
struct FacetAlbedo {
    Real scale;
    Real bias;
};
SRBF_FN FacetAlbedo facet_albedo(Real x, Real y) {
    FacetAlbedo facet;
    facet.scale = clamped_to_unit(
        polynomial(x, polynomial(y, Real(0.1003), Real(9.748), Real(-8.245)),
                  polynomial(y, Real(-0.6303), Real(-2.038), Real(19.99)),
                  polynomial(y, Real(29.34), Real(-26.44), Real(-5.448))) /
        polynomial(x, polynomial(y, Real(1.0), Real(8.263), Real(-7.507)),
                  polynomial(y, Real(-1.765), Real(11.53), Real(15.86)),
                  polynomial(y, Real(28.96), Real(-36.11), Real(33.37))));
    facet.bias = clamped_to_unit(
        polynomial(x, polynomial(y, Real(0.9345), Real(2.229), Real(-0.7684)),
                  polynomial(y, Real(-2.323), Real(-3.748), Real(0.2913)),
                  polynomial(y, Real(1.424), Real(1.436), Real(0.6286))) /
        polynomial(x, polynomial(y, Real(1.0), Real(15.94), Real(41.26)),
                  polynomial(y, Real(0.2281), Real(-55.83), Real(300.2)),
                  polynomial(y, Real(13.08), Real(54.9), Real(-285.1))));
    return facet;
}
// (1 - E) / E, where E is the albedo of facets that reflect all light. Light that is scattered more than once
// multiplies a lobe by 1 + F0 (1 - E) / E (Turquin, "Practical multiple scattering compensation for microfacet
// models", 2019).
SRBF_FN Real multiple_scattering(FacetAlbedo facet) {
    Real whole = max(facet.scale + facet.bias, Real(0.1));
    return max(Real(1.0) - whole, Real(0.0)) / whole;
}
// The albedo of facets with normal reflectance f0, including multiple scattering.
SRBF_FN Real lobe_albedo(FacetAlbedo facet, Real f0) {
    return clamped_to_unit((f0 * facet.scale + facet.bias * clamped_to_unit(Real(50.0) * f0)) *
                     (Real(1.0) + f0 * multiple_scattering(facet)));
}

// The energy-preserving Oren-Nayar model, EON (Portsmouth, Kutz & Hill 2025) [1/sr], with roughness r from 0
// (Lambert) to 1. White reflects all light; rough surfaces of other colours reflect less. eon_share is the albedo
// of white's first scattering, by the paper's polynomial, whose error is 1e-3.
SRBF_FN Real eon_share(Real cosine, Real r) {
    Real m = Real(1.0) - cosine;
    Real g = m * (Real(0.0571085289) + m * (Real(0.491881867) + m * (Real(-0.332181442) + m * Real(0.0714429953))));
    return (Real(1.0) + r * g) / (Real(1.0) + Real(0.28779341) * r);
}
SRBF_FN Real eon_multiple_colour(Real colour, Real mean) {
    return colour * colour * mean / (Real(1.0) - colour * (Real(1.0) - mean));
}
SRBF_FN Vec3 eon_value(Vec3 colour, Real r, Vec3 wl, Vec3 wv) {
    Real s = wl.x * wv.x + wl.y * wv.y;
    Real single_scale = Real(1.0) / (Real(1.0) + Real(0.28779341) * r);
    Real single = single_scale * (Real(1.0) + r * select(Real(0.0) < s, s / max(max(wl.z, wv.z), Real(1.0e-6)), s));
    Real mean = single_scale * (Real(1.0) + Real(0.07248821) * r);
    Real multiple_scale = max(Real(1.0) - eon_share(wl.z, r), Real(1.0e-6)) * max(Real(1.0) - eon_share(wv.z, r), Real(1.0e-6)) /
                 max(Real(1.0) - mean, Real(1.0e-6));
    Vec3 multiple = Vec3(eon_multiple_colour(colour.x, mean), eon_multiple_colour(colour.y, mean), eon_multiple_colour(colour.z, mean));
    return Real(2.0 / SRBF_TWO_PI) * (single * colour + multiple_scale * multiple);
}

// Fuzz: the volume of fibres of Zeltner, Burley & Chiang ("Practical Multiple-Scattering Sheen Using Linearly
// Transformed Cosines", 2022). It is a cosine lobe transformed by ((a, 0, b), (0, a, 0), (0, 0, 1)) in the frame of
// the viewer's azimuth. Albedo, a and b are the functions of cosine and roughness that MaterialX 1.39 fits to the
// paper's table.
SRBF_FN Real fuzz_albedo(Real x, Real y) {
    Real s = y * (Real(0.0206607) + Real(1.58491) * y) / (Real(0.0379424) + y * (Real(1.32227) + y));
    Real m = y * (Real(-0.193854) + y * (Real(-1.14885) + y * (Real(1.7932) - Real(0.95943) * y * y))) /
             (Real(0.046391) + y);
    Real rest = y * (Real(0.000654023) + (Real(-0.0207818) + Real(0.119681) * y) * y) /
                (Real(1.26264) + y * (Real(-1.92021) + y));
    Real t = (x - m) / s;
    return clamped_to_unit(exp_of_lobe(Real(-0.5) * t * t) * Real(0.3989422804) / s + rest);
}
SRBF_FN Real fuzz_value(Vec3 wl, Vec3 wv, Real y) {
    Real x = wv.z;
    Real a = (Real(2.58126) * x + Real(0.813703) * y) * y /
             (Real(1.0) + Real(0.310327) * x * x + Real(2.60994) * x * y);
    Real b = sqrt(max(Real(1.0) - x, Real(0.0))) * (y - Real(1.0)) * y * y * y /
             (Real(0.0000254053) + Real(1.71228) * x - Real(1.71506) * x * y + Real(1.34174) * y * y);
    Real along = (wl.x * wv.x + wl.y * wv.y) * inversesqrt(max(wv.x * wv.x + wv.y * wv.y, Real(1.0e-12)));
    Real across2 = max(wl.x * wl.x + wl.y * wl.y - along * along, Real(0.0));
    Real first = a * along + b * wl.z;
    Real a2 = max(a * a, Real(1.0e-12));
    Real squared = max(first * first + a2 * across2 + wl.z * wl.z, Real(1.0e-8));
    return fuzz_albedo(x, y) * a2 / (squared * squared) * Real(2.0 / SRBF_TWO_PI);
}

// An opaque surface with parameters of OpenPBR Surface 1.1, under the same names. See OpenPbrModel for their
// ranges.
struct OpenPbrSurface {
    Vec3 base_color;
    Real base_metalness;
    Real base_diffuse_roughness;
    Real specular_weight;
    Vec3 specular_color;
    Real specular_roughness;
    Real specular_ior;
    Real coat_weight;
    Vec3 coat_color;
    Real coat_roughness;
    Real coat_ior;
    Real coat_darkening;
    Real fuzz_weight;
    Vec3 fuzz_color;
    Real fuzz_roughness;
};

// alpha for a roughness r: r^2, at least 1/1024.
SRBF_FN Real alpha_of(Real roughness) { return max(roughness * roughness, Real(1.0 / 1024.0)); }

// The roughness of a base under a coat, whose interface spreads the light twice: (r^4 + 2 c^4)^(1/4), at most 1.
SRBF_FN Real roughened(Real base, Real coat, Real weight) {
    Real b2 = base * base;
    Real c2 = coat * coat;
    Real fourth = min(b2 * b2 + Real(2.0) * (c2 * c2), Real(1.0));
    return (Real(1.0) - weight) * base + weight * sqrt(sqrt(fourth));
}

// The Fresnel term of a metal at l . h = c: Schlick's with F0 and F90 = 1, times a tint that is 1 at c = 0 and c =
// 1 and the given one at c = 1/7, approximately 82 degrees ("F82", Kutz et al. 2021).
SRBF_FN Real metal_reflectance(Real c, Real weight, Real f0, Real tint) {
    Real schlick = f0 + (Real(1.0) - f0) * weight;
    Real at_82 = f0 + (Real(1.0) - f0) * Real(0.462664366);
    Real m = Real(1.0) - c;
    Real m2 = m * m;
    return max(schlick - c * (m2 * m2 * m2) * at_82 * (Real(1.0) - tint) * Real(17.651384), Real(0.0));
}

// A film on the base: weight, thickness [1e-6 m] and index of refraction.
struct OpenPbrFilm {
    Real weight;
    Real thickness;
    Real ior;
};

// Facets of the base that are rougher along a tangent than across it: specular_roughness_anisotropy, and the cosine
// and sine of the tangent's azimuth.
struct OpenPbrAnisotropy {
    Real amount;
    Real cosine;
    Real sine;
};

// alpha along the tangent and across it; their root mean square is the one without anisotropy.
struct OpenPbrRoughness {
    Real along;
    Real across;
};
SRBF_FN OpenPbrRoughness openpbr_roughness(Real alpha, Real anisotropy) {
    Real share = Real(1.0) - anisotropy;
    OpenPbrRoughness roughness;
    roughness.along = alpha * sqrt(Real(2.0) / (Real(1.0) + share * share));
    roughness.across = max(share * roughness.along, Real(1.0 / 1024.0));
    return roughness;
}

// 1 - cos(x), |x| <= 128 pi: the angle is doubled five times, 1 - cos(2 a) = 2 v (2 - v) with v = 1 - cos(a).
SRBF_FN Real doubled(Real v) { return Real(2.0) * v * (Real(2.0) - v); }
SRBF_FN Real one_minus_cos(Real x) {
    Real s = sin(x * Real(1.0 / 64.0));
    return doubled(doubled(doubled(doubled(doubled(Real(2.0) * s * s)))));
}
// The colour of a spectrum 1 + cos(2 pi path / wavelength + shift), minus 1, for R, G, B, where `turn` is
// cos(shift). It uses Gaussians fitted to the Fourier transforms of the CIE curves (Belcour & Barla, "A Practical
// Extension to Microfacet Theory for the Modeling of Varying Iridescence", 2017). path [1e-6 m].
SRBF_FN Real film_wave(Real path, Real size, Real frequency, Real decay) {
    return size * (Real(1.0) - one_minus_cos(frequency * path)) * exp_of_lobe(-decay * path * path);
}
SRBF_FN Vec3 film_colour(Real path, Vec3 turn) {
    Real x = turn.x * (film_wave(path, Real(0.84659), Real(10.5620345), Real(0.170854696)) +
                       film_wave(path, Real(0.153868307), Real(14.0737068), Real(0.178766171)));
    Real y = turn.y * film_wave(path, Real(1.00022189), Real(11.2802026), Real(0.367330884));
    Real z = turn.z * film_wave(path, Real(1.00112249), Real(13.8757864), Real(0.261035245));
    return Vec3(Real(3.2404542) * x - Real(1.5371385) * y - Real(0.4985314) * z,
                Real(1.8760108) * y - Real(0.9692660) * x + Real(0.0415560) * z,
                Real(0.0556434) * x - Real(0.2040259) * y + Real(1.0572252) * z);
}

// The reflectance of a film on a base of reflectance f0 at an angle of cosine c: the reflections at the two
// interfaces, with Schlick's Fresnel terms, and two orders of their interference, as in KHR_materials_iridescence
// of glTF.
struct FilmBase {
    Real reflectance;  // of the base inside the film
    Real turn;         // -1 if the wave reflected by the base keeps its sign
};
SRBF_FN FilmBase film_base(Real f0, Real ior, Real schlick) {
    Real root = sqrt(min(f0, Real(0.9999)));
    Real below = (Real(1.0) + root) / (Real(1.0) - root);
    Real share = (below - ior) / (below + ior);
    FilmBase base;
    base.reflectance = share * share + (Real(1.0) - share * share) * schlick;
    base.turn = select(below < ior, Real(1.0), Real(-1.0));
    return base;
}
SRBF_FN Real film_order(FilmBase base, Real above, Real first, Real second) {
    Real both = min(max(above * base.reflectance, Real(1.0e-5)), Real(0.9999));
    Real through = Real(1.0) - above;
    Real returned = through * through * base.reflectance / (Real(1.0) - both);
    return max(above + returned + Real(2.0) * (returned - through) * (sqrt(both) * first + both * second), Real(0.0));
}
SRBF_FN Real fifth_power(Real x) { return (x * x) * (x * x) * x; }
SRBF_FN Vec3 film_reflectance(OpenPbrFilm film, Vec3 f0, Real c) {
    Real within = sqrt(max(Real(1.0) - (Real(1.0) - c * c) / (film.ior * film.ior), Real(0.0)));
    Real normal = normal_reflectance(film.ior);
    Real above = normal + (Real(1.0) - normal) * fifth_power(Real(1.0) - c);
    Real schlick = fifth_power(Real(1.0) - within);
    FilmBase r = film_base(f0.x, film.ior, schlick);
    FilmBase g = film_base(f0.y, film.ior, schlick);
    FilmBase b = film_base(f0.z, film.ior, schlick);
    Real path = Real(2.0) * film.ior * film.thickness * within;
    Vec3 first = film_colour(path, Vec3(r.turn, g.turn, b.turn));
    Vec3 second = film_colour(Real(2.0) * path, Vec3(Real(1.0), Real(1.0), Real(1.0)));
    return Vec3(film_order(r, above, first.x, second.x), film_order(g, above, first.y, second.y),
                film_order(b, above, first.z, second.z));
}

// The base under a coat: its index of refraction is relative to the coat's. The specular weight scales F0 of the
// dielectric, whose index is the one with the scaled F0.
struct OpenPbrBase {
    Real f0;
    Real ior;
    Real alpha;
};
SRBF_FN OpenPbrBase openpbr_base(OpenPbrSurface material) {
    Real coat_ior = Real(1.0) + material.coat_weight * (material.coat_ior - Real(1.0));
    Real ratio = material.specular_ior / coat_ior;
    OpenPbrBase base;
    Real f0 = normal_reflectance(max(max(ratio, Real(1.0) / ratio), Real(1.0)));
    base.f0 = min(material.specular_weight * f0, Real(0.98));
    Real root = sqrt(base.f0);
    base.ior = (Real(1.0) + root) / (Real(1.0) - root);
    base.alpha = alpha_of(roughened(material.specular_roughness, material.coat_roughness, material.coat_weight));
    return base;
}
SRBF_FN Real half_cosine(Vec3 wl, Vec3 wv) {
    Vec3 sum = wl + wv;
    return min(Real(0.5) * sqrt(dot(sum, sum)), Real(1.0));
}

// The reflectances of the base's facets, for R, G, B: of the dielectric and of the metal, at l . h, and F0 of both.
struct OpenPbrFacets {
    Vec3 dielectric;
    Vec3 metal;
    Vec3 dielectric_f0;
    Vec3 metal_f0;
};
SRBF_FN OpenPbrFacets openpbr_facets(OpenPbrSurface material, OpenPbrBase base, Vec3 wl, Vec3 wv) {
    Real c = half_cosine(wl, wv);
    Real schlick = schlick_weight(wl, wv);
    Real plain = dielectric_reflectance(c, base.ior);
    Vec3 f0 = material.base_color;
    OpenPbrFacets facets;
    facets.dielectric = Vec3(plain, plain, plain);
    facets.metal = Vec3(metal_reflectance(c, schlick, f0.x, material.specular_color.x),
                        metal_reflectance(c, schlick, f0.y, material.specular_color.y),
                        metal_reflectance(c, schlick, f0.z, material.specular_color.z));
    facets.dielectric_f0 = Vec3(base.f0, base.f0, base.f0);
    facets.metal_f0 = f0;
    return facets;
}
// The reflectances under a film, whose weight is the fraction of the surface that it covers.
SRBF_FN OpenPbrFacets openpbr_film_facets(OpenPbrSurface material, OpenPbrFilm film, OpenPbrBase base, Vec3 wl,
                                          Vec3 wv) {
    OpenPbrFacets facets = openpbr_facets(material, base, wl, wv);
    Real c = half_cosine(wl, wv);
    facets.dielectric = interpolated(facets.dielectric, film_reflectance(film, facets.dielectric_f0, c), film.weight);
    facets.metal = interpolated(facets.metal, film_reflectance(film, facets.metal_f0, c), film.weight);
    Vec3 f0 = facets.dielectric_f0;
    facets.dielectric_f0 = interpolated(f0, film_reflectance(film, f0, Real(1.0)), film.weight);
    f0 = facets.metal_f0;
    facets.metal_f0 = interpolated(f0, film_reflectance(film, f0, Real(1.0)), film.weight);
    return facets;
}

// The base: a dielectric over EON, blended with a metal by base_metalness [1/sr]. The light that the dielectric
// reflects towards the viewer is subtracted from the diffuse part (albedo scaling): a factor 1 - E(wv).
SRBF_FN Vec3 multiple_scattering_by(Vec3 f0, Real factor) {
    return Vec3(Real(1.0) + f0.x * factor, Real(1.0) + f0.y * factor, Real(1.0) + f0.z * factor);
}
SRBF_FN Vec3 openpbr_base_value(OpenPbrSurface material, OpenPbrBase base, OpenPbrFacets facets, Real density, Vec3 wl,
                                Vec3 wv) {
    FacetAlbedo whole = facet_albedo(wv.z, base.alpha);
    Real multiple = multiple_scattering(whole);
    Vec3 f0 = facets.dielectric_f0;
    Vec3 dielectric = density * product_of(facets.dielectric, multiple_scattering_by(f0, multiple));
    Vec3 through = Vec3(Real(1.0) - lobe_albedo(whole, f0.x), Real(1.0) - lobe_albedo(whole, f0.y),
                        Real(1.0) - lobe_albedo(whole, f0.z));
    Vec3 glossy = product_of(dielectric, material.specular_color) +
                  product_of(through, eon_value(material.base_color, material.base_diffuse_roughness, wl, wv));
    Vec3 metal = (material.specular_weight * density) *
                 product_of(facets.metal, multiple_scattering_by(facets.metal_f0, multiple));
    return interpolated(glossy, metal, material.base_metalness);
}

// The factor by which reflections between a coat and a base of this colour darken it, relative to a base without
// the coat: (1 - K) / (1 - colour K). K = 1 - (1 - F0) / ior^2 is the coat's internal reflectance of diffuse light.
SRBF_FN Real darkened(Real colour, Real k, Real strength) {
    return Real(1.0) - strength + strength * (Real(1.0) - k) / (Real(1.0) - colour * k);
}

// rho(wl, wv) of the surface [1/sr], for R, G, B: fuzz over a coat over the base. Each layer reduces what lies
// below by its directional albedo at the viewer, E(wv), so that the BRDF is not reciprocal. The coat's colour is
// the transmittance of two passes, at any angle.
SRBF_FN Vec3 openpbr_layers_value(OpenPbrSurface material, Vec3 base, Vec3 wl, Vec3 wv) {
    Real c = half_cosine(wl, wv);
    Real alpha = alpha_of(material.coat_roughness);
    FacetAlbedo whole = facet_albedo(wv.z, alpha);
    Real f0 = normal_reflectance(material.coat_ior);
    Real coat = material.coat_weight * ggx_facets(wl, wv, alpha) * dielectric_reflectance(c, material.coat_ior) *
                (Real(1.0) + f0 * multiple_scattering(whole));
    Real k = Real(1.0) - (Real(1.0) - f0) / (material.coat_ior * material.coat_ior);
    Real strength = material.coat_weight * material.coat_darkening;
    Vec3 dark = Vec3(darkened(material.base_color.x, k, strength), darkened(material.base_color.y, k, strength),
                     darkened(material.base_color.z, k, strength));
    Vec3 white = Vec3(Real(1.0), Real(1.0), Real(1.0));
    Vec3 passed = product_of(dark, interpolated(white, material.coat_color, material.coat_weight));
    Real through = Real(1.0) - material.coat_weight * lobe_albedo(whole, f0);
    Vec3 coated = Vec3(coat, coat, coat) + through * product_of(passed, base);

    Real y = max(material.fuzz_roughness, Real(0.01));
    Real below = Real(1.0) - material.fuzz_weight * fuzz_albedo(wv.z, y);
    return below * coated + (material.fuzz_weight * fuzz_value(wl, wv, y)) * material.fuzz_color;
}
SRBF_FN Vec3 openpbr_value(OpenPbrSurface material, Vec3 wl, Vec3 wv) {
    OpenPbrBase base = openpbr_base(material);
    Real density = ggx_facets(wl, wv, base.alpha);
    OpenPbrFacets facets = openpbr_facets(material, base, wl, wv);
    return openpbr_layers_value(material, openpbr_base_value(material, base, facets, density, wl, wv), wl, wv);
}
// rho of a surface with a film on the base.
SRBF_FN Vec3 openpbr_film_value(OpenPbrSurface material, OpenPbrFilm film, Vec3 wl, Vec3 wv) {
    OpenPbrBase base = openpbr_base(material);
    OpenPbrFacets facets = openpbr_film_facets(material, film, base, wl, wv);
    Real density = ggx_facets(wl, wv, base.alpha);
    return openpbr_layers_value(material, openpbr_base_value(material, base, facets, density, wl, wv), wl, wv);
}
// rho of a surface with a film, whose weight may be 0, on facets that are rougher along a tangent than across it.
// Their albedo is that of facets with the geometric mean of both roughnesses.
SRBF_FN Vec3 openpbr_anisotropic_value(OpenPbrSurface material, OpenPbrFilm film, OpenPbrAnisotropy anisotropy, Vec3 wl,
                                       Vec3 wv) {
    OpenPbrBase base = openpbr_base(material);
    OpenPbrRoughness roughness = openpbr_roughness(base.alpha, anisotropy.amount);
    Real density = ggx_stretched_facets(turned(wl, anisotropy.cosine, -anisotropy.sine),
                                        turned(wv, anisotropy.cosine, -anisotropy.sine), roughness.along,
                                        roughness.across);
    base.alpha = sqrt(roughness.along * roughness.across);
    OpenPbrFacets facets = openpbr_film_facets(material, film, base, wl, wv);
    return openpbr_layers_value(material, openpbr_base_value(material, base, facets, density, wl, wv), wl, wv);
}
