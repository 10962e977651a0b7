// Fits of models with a few nonlinear parameters (GGX, OpenPBR), by finite differences.
#pragma once
#include <Eigen/Dense>

#include "base/levenberg_marquardt.h"
#include "base/parallel.h"
#include "observe/observations.h"
#include "observe/pixels.h"

namespace SRBF_NAMESPACE {

/// The data of a fit, and its loss: the mean of ρ(ΔE_ITP) over pixels (see `Pixels`) plus Σ w |f − f̂|² over pairs, if
/// no pictures are observed or pairs are added. A model's outputs are the colours of pixels and the values at pairs.
class SurfaceData {
  public:
    using Outputs = Aligned<float>;  ///< blocks with a column for each channel

    /// Uses every n-th view. If there are no views, uses the first n-th part of the pairs.
    SurfaceData(const Observations& observations, std::size_t n);
    /// Adds the first n-th part of the pairs. For this model they are `fraction` times the loss of the pixels.
    void add_pairs(const Observations& observations, std::size_t n, const Evaluate& model, double fraction);

    /// `f` is a buffer for values of the model.
    void compute_outputs(const Evaluate& model, std::vector<Rgb>& f, Outputs& outputs) const;
    double loss(const Outputs& outputs, PixelSlopes& slopes) const;
    /// JᵀJ and Jᵀr from the outputs and their derivatives by each variable.
    void linearise(const Outputs& outputs, const std::vector<Outputs>& derivatives, PixelSlopes& slopes,
                   Eigen::MatrixXd& H, Eigen::VectorXd& g) const;

  private:
    /// The rows of a pixel, and the index of its first weight.
    struct Pixel {
        std::size_t first, count, weight;
    };

    void add_views(const Observations& observations, std::size_t n);
    void add_pairs(const Observations& observations, std::size_t n);
    double pair_loss(const Outputs& outputs) const;
    void add_pair_rows(const Outputs& outputs, const std::vector<Outputs>& derivatives, Eigen::MatrixXd& H,
                       Eigen::VectorXd& g) const;
    void add_pixel_rows(const Outputs& outputs, const std::vector<Outputs>& derivatives, PixelSlopes& slopes,
                        Eigen::MatrixXd& H, Eigen::VectorXd& g) const;

    std::vector<Vec3f> wl_, wv_;  ///< directions of pixels, then of pairs
    std::vector<Pixel> pixel_;
    std::vector<float> light_;
    Pixels pixels_;
    // Values and weights of pairs.
    std::vector<Rgb> f_;
    std::vector<double> weight_;
};

/// The loss of a model as a function of variables x ≥ 0, for `levenberg_marquardt`. `Variables` has the members
/// model(x), x_of(model) and max(), the upper bounds of x.
template <typename Variables> class SurfaceProblem {
  public:
    SurfaceProblem(const SurfaceData& data, Variables variables)
        : data_(data), variables_(std::move(variables)), max_(variables_.max()) {
        derivatives_.resize(std::size_t(max_.size()));
    }

    auto model(const Eigen::VectorXd& x) const { return variables_.model(x); }
    template <typename Model> Eigen::VectorXd x_of(const Model& model) const { return variables_.x_of(model); }

    double loss(const Eigen::VectorXd& x) { return loss(model(x)); }
    template <typename Model> double loss(const Model& model) {
        data_.compute_outputs(evaluator(model), f_, outputs_);
        return data_.loss(outputs_, slopes_);
    }
    void linearise(const Eigen::VectorXd& x, Eigen::MatrixXd& H, Eigen::VectorXd& g) {
        constexpr double k_slope_step = 1e-3;
        for (std::size_t i = 0; i < derivatives_.size(); ++i) {
            Eigen::VectorXd changed = x;
            double& variable = changed[Eigen::Index(i)];
            const double step = variable + k_slope_step <= max_[Eigen::Index(i)] ? k_slope_step : -k_slope_step;
            variable += step;
            SurfaceData::Outputs& derivative = derivatives_[i];
            const auto model_beside = model(changed);
            data_.compute_outputs(evaluator(model_beside), f_, derivative);
            for (std::size_t k = 0; k < derivative.size(); ++k)
                derivative[k] = float((double(derivative[k]) - double(outputs_[k])) / step);
        }
        data_.linearise(outputs_, derivatives_, slopes_, H, g);
    }
    Eigen::VectorXd lower(const Eigen::VectorXd& x) const { return Eigen::VectorXd::Zero(x.size()); }
    Eigen::VectorXd upper(const Eigen::VectorXd&) const { return max_; }
    Eigen::VectorXd longest_step(const Eigen::VectorXd& x) const { return Eigen::VectorXd::Constant(x.size(), 0.25); }

  private:
    const SurfaceData& data_;
    Variables variables_;
    Eigen::VectorXd max_;
    std::vector<Rgb> f_;
    SurfaceData::Outputs outputs_;
    std::vector<SurfaceData::Outputs> derivatives_;  ///< derivatives of the outputs by each variable
    PixelSlopes slopes_;
};

template <typename Model> struct SurfaceCandidate {
    Model model;
    double loss = 0;
};

/// A round of a search: the number of candidates that it takes, the n of `SurfaceData`, and the number of steps.
struct SurfaceRound {
    std::size_t candidates, subsampling;
    int steps;
};

/// Improves the first candidates by Levenberg-Marquardt in the variables `variables_of(model)`, and sorts them by loss.
template <typename Model, typename VariablesOf>
void refine_candidates(std::vector<SurfaceCandidate<Model>>& candidates, const SurfaceRound& round,
                       const SurfaceData& data, const VariablesOf& variables_of, int threads) {
    candidates.resize(std::min(candidates.size(), round.candidates));
    parallel_for(candidates.size(), threads, [&](std::size_t i) {
        auto& [model, loss] = candidates[i];
        SurfaceProblem problem(data, variables_of(model));
        Eigen::VectorXd x = problem.x_of(model);
        loss = round.steps == 0
                   ? problem.loss(x)
                   : levenberg_marquardt(problem, x, {.max_iterations = round.steps, .adapts_to_bounds = true}).loss;
        model = problem.model(x);
    });
    std::ranges::stable_sort(candidates, {}, &SurfaceCandidate<Model>::loss);
}

}  // namespace
