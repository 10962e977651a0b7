// Numbers of a model as variables of a search.
#pragma once
#include <Eigen/Dense>

#include "models/kind/numbers.h"

namespace SRBF_NAMESPACE {

/// A number as a variable x in [0, 1] of the search: x is the fraction of the range from `min` to the
/// member's largest value. For a colour the fraction is x², which is closer to visible differences.
template <typename M> struct NumberVariable {
    const Member<M>* member;
    int channel;
    float min;
};
/// The variables of a search; other numbers of the model are those of `fixed`.
template <typename M> struct NumberVariables {
    std::vector<NumberVariable<M>> all;
    M fixed;

    M model(const Eigen::VectorXd& x) const {
        M model = fixed;
        for (std::size_t i = 0; i < all.size(); ++i) {
            const auto [member, c, min] = all[i];
            const double root = x[Eigen::Index(i)], fraction = member->colour ? root * root : root;
            for (int k = c; k < member->count(); ++k)  // a grey colour has one variable, its first channel
                number(model, *member, k) = float(double(min) + fraction * double(member->max - min));
        }
        return model;
    }
    Eigen::VectorXd x_of(const M& model) const {
        Eigen::VectorXd x(Eigen::Index(all.size()));
        for (std::size_t i = 0; i < all.size(); ++i) {
            const auto [member, c, min] = all[i];
            const double fraction = std::max(double(number(model, *member, c) - min) / double(member->max - min), 0.0);
            x[Eigen::Index(i)] = member->colour ? std::sqrt(fraction) : fraction;
        }
        return x;
    }
    Eigen::VectorXd max() const { return Eigen::VectorXd::Ones(Eigen::Index(all.size())); }
};

}  // namespace
