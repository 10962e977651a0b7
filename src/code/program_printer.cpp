#include "code/program_printer.h"

#include "code/print.h"

namespace SRBF_NAMESPACE {
namespace {

template <typename Visit> void visit_definitions(const syntax::Program& program, const Visit& visit) {
    for (const auto& structure : program.structures) visit(structure);
    for (const auto& table : program.tables) visit(table);
    for (const auto& function : program.functions) visit(function);
}

}  // namespace

ProgramPrinter::ProgramPrinter(std::vector<NamedProgram> programs, std::string_view prefix, CodeLanguage language,
                               Names entries)
    : programs_(std::move(programs)),
      prefix_(std::string(prefix) + "_"),
      language_(language),
      entries_(std::move(entries)) {
    for (const auto& [name, printed_name] : entries_) own_.insert(name);
    for (const auto& named : programs_)
        for (const syntax::Table& table : named.program.tables) own_.insert(table.name);
    while (separate()) {
    }
}

Result<Done> ProgramPrinter::add_names(DefinedNames& defined) const {
    for (std::size_t i = 0; i < programs_.size(); ++i) {
        const Names printed_names = names(i);
        Result<Done> added = Done{};
        visit_definitions(programs_[i].program, [&](const auto& definition) {
            if (added && own_.contains(definition.name))
                added = defined.add(printed_names.at(definition.name), programs_[i].name);
        });
        if (!added) return added;
    }
    return Done{};
}

std::string ProgramPrinter::text() const {
    std::string shared, own_texts;
    std::set<std::string> known;
    for (std::size_t i = 0; i < programs_.size(); ++i) {
        syntax::Printer printer(language_, names(i));
        std::string definitions;
        visit_definitions(programs_[i].program, [&](const auto& definition) {
            if (own_.contains(definition.name))
                definitions += printer.text(definition) + "\n";
            else if (known.insert(definition.name).second)
                shared += printer.text(definition) + "\n";
        });
        own_texts += syntax::comment_text(programs_[i].description) + "\n" + definitions;
    }
    return shared + own_texts;
}

Names ProgramPrinter::names(std::size_t i) const {
    Names names;
    const std::string prefix = programs_[i].name + "_";
    visit_definitions(programs_[i].program, [&](const auto& definition) {
        names[definition.name] = (own_.contains(definition.name) ? prefix : prefix_) + definition.name;
    });
    for (const auto& [name, printed_name] : entries_) names[name] = prefix + printed_name;
    return names;
}

bool ProgramPrinter::separate() {
    Names texts;
    const std::size_t before = own_.size();
    for (const NamedProgram& named : programs_)
        for (const syntax::Function& function : named.program.functions) {
            for (const syntax::Variable& parameter : function.parameters)
                if (own_.contains(parameter.type.name)) own_.insert(function.name);
            syntax::visit_expressions(function.body, [&](const syntax::Expression& part) {
                if (own_.contains(part.text)) own_.insert(function.name);
            });
        }
    for (std::size_t i = 0; i < programs_.size(); ++i) {
        syntax::Printer printer(language_, names(i));
        visit_definitions(programs_[i].program, [&](const auto& definition) {
            if (own_.contains(definition.name)) return;
            const std::string text = printer.text(definition);
            if (texts.emplace(definition.name, text).first->second != text) own_.insert(definition.name);
        });
    }
    return own_.size() != before;
}

}  // namespace
