// The gallery of a report, its first page.
#include <fmt/format.h>

#include "base/printable.h"
#include "errors/picture_errors.h"
#include "errors/sphere.h"
#include "extras/report/page.h"
#include "extras/report/parts.h"
#include "report/report_text.h"

namespace SRBF_NAMESPACE {
namespace {

std::string lead_of(const View& view, const std::string& note) {
    std::string html;
    if (!note.empty()) html += fmt::format("<p class='wrong'>{}</p>\n", html_escaped(note));
    std::string counts;
    for (std::size_t k = 0; k < k_verdicts; ++k) {
        const Json* row = rows_with(view.tables.summary, "what", words(Verdict(k)))[0];
        if (row->at("materials") == 0) continue;
        counts += fmt::format("{}{} for {}", counts.empty() ? "" : ", ", verdict_text(words(Verdict(k))),
                              number(row, "materials", NumberFormat::whole));
    }
    if (counts.empty()) return html;
    html += fmt::format("<p class='lead'>The difference between measurement and fit is {}.", counts);
    // The default fits of tables all have the same size.
    const auto statistics =
        rows_with(view.tables.statistics, "id", fmt::format("pm-extended-8x4-{}", name(k_default_objective)));
    if (const Json* statistic = row_with(statistics, "measure", "delta_e_itp"))
        html += fmt::format(" The default fit of a table has {} bytes. Its median ΔE_ITP is {}, the maximum {} ({}).",
                            number(statistic, "payload_bytes", NumberFormat::whole),
                            number(statistic, "median", NumberFormat::plain),
                            number(statistic, "worst", NumberFormat::plain), text_of(*statistic, "worst_material"));
    return html + "</p>";
}

/// The verdicts with their limits: "hardly visible up to a ΔE_ITP of 1 and a ꟻLIP of 0.03, ..."
std::string verdicts_text() {
    std::string text;
    for (std::size_t k = 0; k < k_verdict_limits.size(); ++k)
        text += fmt::format("{} up to {:g} and {:g}, ", verdict_text(words(Verdict(k))), k_verdict_limits[k].delta_e,
                            k_verdict_limits[k].flip);
    return text + verdict_text(words(Verdict::other)) + " above";
}

std::string failed_of(const View& view) {
    std::string html;
    for (const Json* material : rows_with(view.tables.materials, "status", "failed"))
        html += fmt::format("<li><b>{}</b>{}: {}</li>\n", text_of(*material, "material"), label_of(*material),
                            text_of(*material, "error"));
    if (html.empty()) return html;
    return fmt::format("<div class='wrong' id='failed'>Not shown because of errors:<ul>\n{}</ul></div>", html);
}

std::string card_of(const View& view, const Json& material) {
    const Json* fit = view.fit_with_role(material, "pm");
    if (fit == nullptr) return {};
    std::string figures;
    for (const char* role : {"measured", "pm", "ggx"})
        if (const Json* ball = view.ball(material, role))
            figures +=
                fmt::format("<figure><img src='{}/{}.jpg' alt='{}' loading='lazy'><figcaption>{}</figcaption></figure>",
                            text_of(material, "folder"), text_of(*ball, "picture"), role_title(role),
                            role == std::string_view("pm") ? "fitted" : role_title(role));
    const Json& error = fit->at("delta_e_itp");
    return fmt::format(
        "<article class='card' data-error='{}' data-name='{}' data-kind='{}'>\n<a href='{}/index.html'>{}</a>\n"
        "<p>{}{}</p>\n<p>{}{}</p>\n<p>{}, {} bytes; fitted {} bytes</p></article>\n",
        error.is_number() ? field(error) : "1e9", text_of(material, "material"), text_of(material, "format"),
        text_of(material, "folder"), figures, link_to(material), label_of(material), verdict_text(material["verdict"]),
        error.is_number() ? ": ΔE_ITP " + number(error, NumberFormat::plain) : "", text_of(material, "format"),
        number(&material, "source_bytes", NumberFormat::whole), number(fit, "payload_bytes", NumberFormat::whole));
}

}  // namespace

std::string gallery_html(const std::vector<MaterialEntry>& materials, const Tables& tables, const std::string& note) {
    const View view{tables};
    std::string cards;
    for (const Json* material : view.by_visible_error()) cards += card_of(view, *material);
    const std::string title =
        materials.size() == 1 ? materials[0].name + ": measured and fitted" : "Measured materials and their fits";
    return page(
        html_escaped(title), k_gallery_text,
        {{"lead", lead_of(view, note)}, {"failed", failed_of(view)}, {"cards", cards}, {"verdicts", verdicts_text()}});
}

}  // namespace srbf
