#include "srbf/prepared.h"

#include "model/pm_numbers.h"

namespace srbf {

struct PreparedModel::Contents {
    std::variant<PmNumbers, SuModel, GgxModel> model;
    Proposal proposal{};  // by the cosine
};

namespace {

std::shared_ptr<PreparedModel::Contents> contents_of(const Model& model) {
    using Contents = PreparedModel::Contents;
    if (const auto* pm = std::get_if<PmModel>(&model.model))
        return std::make_shared<Contents>(Contents{PmNumbers(*pm)});
    if (const auto* su = std::get_if<SuModel>(&model.model)) return std::make_shared<Contents>(Contents{*su});
    return std::make_shared<Contents>(Contents{std::get<GgxModel>(model.model)});
}

}  // namespace

PreparedModel::PreparedModel(std::shared_ptr<const Contents> contents) : contents_(std::move(contents)) {
    std::visit(
        [&]<typename M>(const M& held) {
            model_ = &held;
            if constexpr (std::is_same_v<M, PmNumbers>)
                value_ = pair_evaluator(held);
            else
                value_ = [](const void* any, const Vec3f& wl, const Vec3f& wv, float* colour) {
                    const Rgb f = srbf::value(*static_cast<const M*>(any), wl, wv);
                    std::copy_n(&f.r, 3, colour);
                };
        },
        contents_->model);
}

const Proposal& PreparedModel::proposal() const { return contents_->proposal; }

PreparedModel prepare(const Model& model) { return PreparedModel(contents_of(model)); }

PreparedModel prepare(const Model& model, const ProposeOptions& options) {
    const auto contents = contents_of(model);
    contents->proposal = propose(model, options);
    if (auto* by_view = std::get_if<ViewProposal>(&contents->proposal))
        by_view->model = &std::get<SuModel>(contents->model);
    return PreparedModel(contents);
}

void evaluate(const PreparedModel& model, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f) {
    std::visit([&](const auto& m) { evaluate(m, wl, wv, f); }, model.contents().model);
}

Evaluate evaluator(PreparedModel model) {
    return [model = std::move(model)](auto wl, auto wv, auto f) { evaluate(model, wl, wv, f); };
}

Vec3f sample(const PreparedModel& model, Vec3f wv, Vec3f u) { return sample(model.proposal(), wv, u); }
float pdf(const PreparedModel& model, Vec3f wl, Vec3f wv) { return pdf(model.proposal(), wl, wv); }

}  // namespace srbf
