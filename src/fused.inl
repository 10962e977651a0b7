// Products that become fused multiply-adds, always the same ones whatever a compiler prefers, for number types B with
// product, multiply_add, multiply_subtract and subtract_product, whose a * b is a Product<B>. Without include guard:
// SIMD code includes it once per instruction set, the text of the CUDA backend once, each with SRBF_FUSED, a prefix of
// functions.

// The product a b, not yet evaluated: adding to it gives a fused multiply-add, always the same one.
template <typename B> struct Product {
    B a, b;
    SRBF_FUSED Product(B a_, B b_) : a(a_), b(b_) {}
    SRBF_FUSED operator B() const { return product(a, b); }
    SRBF_FUSED void store(float* p) const { product(a, b).store(p); }
    friend SRBF_FUSED B operator+(Product p, B c) { return multiply_add(p.a, p.b, c); }
    friend SRBF_FUSED B operator+(B c, Product p) { return multiply_add(p.a, p.b, c); }
    friend SRBF_FUSED B operator+(Product p, Product q) { return multiply_add(q.a, q.b, product(p.a, p.b)); }
    friend SRBF_FUSED B operator-(Product p, B c) { return multiply_subtract(p.a, p.b, c); }
    friend SRBF_FUSED B operator-(B c, Product p) { return subtract_product(c, p.a, p.b); }
    friend SRBF_FUSED B operator-(Product p, Product q) { return subtract_product(product(p.a, p.b), q.a, q.b); }
};

// s v.
template <typename B> struct Scaled {
    B s;
    Vec3<B> v;
    SRBF_FUSED Scaled(B s_, Vec3<B> v_) : s(s_), v(v_) {}
    SRBF_FUSED operator Vec3<B>() const { return {s * v.x, s * v.y, s * v.z}; }
    friend SRBF_FUSED Vec3<B> operator+(Vec3<B> u, Scaled p) {
        return {u.x + p.s * p.v.x, u.y + p.s * p.v.y, u.z + p.s * p.v.z};
    }
    friend SRBF_FUSED Vec3<B> operator-(Vec3<B> u, Scaled p) {
        return {u.x - p.s * p.v.x, u.y - p.s * p.v.y, u.z - p.s * p.v.z};
    }
    friend SRBF_FUSED Vec3<B> operator-(Scaled p, Vec3<B> u) {
        return {p.s * p.v.x - u.x, p.s * p.v.y - u.y, p.s * p.v.z - u.z};
    }
    friend SRBF_FUSED Vec3<B> operator+(Scaled p, Scaled q) { return Vec3<B>(p) + q; }
    friend SRBF_FUSED Vec3<B> operator-(Scaled p, Scaled q) { return Vec3<B>(p) - q; }
};
#undef SRBF_FUSED
