// Properties of the table of a fit's options, and of the requests that are made of texts.
#include "fit/fit_options.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "brdf/directions.h"
#include "fit/request_traits.h"
#include "properties.h"

namespace srbf::fit_options_test {
namespace {

/// The texts that an option needs beside it.
FitTexts with(const FitOptionRow& option, const std::string& text) {
    FitTexts texts{{std::string(option.name), text}};
    if (!option.models.empty()) texts["model"] = option.models.front();
    return texts;
}

/// A text that an option accepts.
std::string accepted(const FitOptionRow& option) {
    if (!option.choices.empty()) return option.choices.back();
    if (option.type.empty()) return "true";
    return option.expected.substr(0, option.expected.find(' '));
}

TEST(OptionsOfAFit, AcceptTheirTextsAndRefuseOthersByName) {
    for (const FitOptionRow& option : fit_options()) {
        EXPECT_TRUE(fit_request(with(option, accepted(option))).ok()) << option.name;
        for (const char* text : {"", "nan", "-1", "1e99", "no such word"}) {
            const auto refused = fit_request(with(option, text));
            ASSERT_FALSE(refused.ok()) << option.name << " " << text;
            EXPECT_EQ(refused.error().what, option.name);
            EXPECT_TRUE(refused.error().expected.starts_with(option.expected)) << option.name;
            EXPECT_EQ(refused.error().found, text);
        }
        for (const std::string& text : option.choices)
            EXPECT_TRUE(fit_request(with(option, text)).ok()) << option.name << " " << text;
        if (!option.preset.empty()) {
            EXPECT_TRUE(fit_request(with(option, option.preset)).ok()) << option.name;
        }
    }
}

TEST(OptionsOfAFit, AreReadByTheirModelsAlone) {
    for (const FitOptionRow& option : fit_options())
        for (const std::string_view model : k_model_names) {
            FitTexts texts = with(option, accepted(option));
            texts["model"] = model;
            const bool is_read = std::ranges::any_of(fit_options(), [&](const FitOptionRow& row) {
                return row.name == option.name && std::ranges::count(row.models, model) > 0;
            });
            if (is_read || option.models.empty() || option.name == "model") continue;
            const auto refused = fit_request(texts);
            ASSERT_FALSE(refused.ok()) << option.name << " " << model;
            EXPECT_CONTAINS(message(refused.error()), "only with model ");
        }
}

TEST(OptionsOfAFit, SetWhatTheyName) {
    const FitTexts texts{{"lobes", "3"},      {"variates", "2"},    {"axial", "false"},
                         {"max_theta", "70"}, {"objective", "raw"}, {"seed", "18446744073709551615"}};
    const auto request = checked(fit_request(texts));
    const auto& pm = std::get<PmRequest>(request->model);
    EXPECT_EQ(std::get<LobeCount>(*pm.size).lobes, 3);
    EXPECT_EQ(pm.variates, 2);
    EXPECT_EQ(pm.axial, false);
    EXPECT_EQ(request->max_theta, 70 * k_degree);
    EXPECT_EQ(request->objective, Objective::raw);
    EXPECT_EQ(request->seed, 18446744073709551615u);
    const auto automatic = fit_request({{"lobes", "auto"}});
    EXPECT_TRUE(std::holds_alternative<AutomaticLobes>(*std::get<PmRequest>(automatic->model).size));
}

TEST(OptionsOfAFit, ExcludeEachOtherInTheSpellingOfWhoeverGivesThem) {
    const Spelling loud = [](std::string_view name) { return "<" + std::string(name) + ">"; };
    const std::pair<FitTexts, std::string> wrong[] = {
        {{{"target_delta_e", "3"}, {"lobes", "3"}},
         "<target_delta_e>: chooses the number of lobes; not together with <lobes>"},
        {{{"model", "ggx"}, {"channels", "spectral"}}, "<channels>: spectral only with <model> pm"},
        {{{"as_measured", "true"}, {"form", "extended"}},
         "<as_measured>: not together with <form>; forms that are not reciprocal imply it"},
        {{{"model", "ggx"}, {"lobes", "3"}}, "<lobes>: expected 1 to 2 with <model> ggx, found 3"},
        {{{"model", "ggx"}, {"form", "gaussian"}}, "<form>: only with <model> pm, found ggx"},
    };
    for (const auto& [texts, error] : wrong) {
        const auto refused = fit_request(texts, loud);
        ASSERT_FALSE(refused.ok()) << error;
        EXPECT_EQ(message(refused.error()), error);
    }
    EXPECT_TRUE(message(fit_request({{"lobs", "3"}}, loud).error()).ends_with("<seed>, <threads>, found <lobs>"));
}

}  // namespace
}  // namespace srbf::fit_options_test
