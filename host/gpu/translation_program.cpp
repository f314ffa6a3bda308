#include "host/gpu/translation_program.hpp"

#include <algorithm>
#include <span>

namespace cowgpu::gpu {
namespace {

using engine::TranslationRecord;
using engine::TranslationStep;
using plan::Translations;

constexpr std::size_t rows_at_once = engine::translation_rows;
static_assert(engine::translation_densities == plan::densities);

constexpr std::uint32_t no_place = ~std::uint32_t(0);

// Products of the blocks, with four rows each; places count from the arrays' beginnings. Blocks next to each other that read the
// same column are one. Rows that are missing are zeros for no place.
std::vector<TranslationRecord> products(std::span<const Translations::Block> blocks, const double* entries,
                                        std::vector<double>& matrix) {
  std::vector<TranslationRecord> made;
  for (std::size_t begin = 0; begin < blocks.size();) {
    struct Row {
      const double* entries;
      std::size_t stride;
      std::uint32_t place;
    };
    const Translations::Block& first = blocks[begin];
    std::vector<Row> rows;
    std::size_t end = begin;
    for (; end < blocks.size() && blocks[end].columns == first.columns && blocks[end].first == first.first &&
           blocks[end].stride == first.stride;
         ++end)
      for (std::size_t r = 0; r < blocks[end].count; ++r)
        rows.push_back({entries + blocks[end].matrix + r, blocks[end].count, blocks[end].rows[r]});
    begin = end;
    for (std::size_t row = 0; row < rows.size(); row += rows_at_once) {
      TranslationRecord record{TranslationStep::multiply};
      record.place = first.first;
      record.entries = std::uint32_t(matrix.size());
      record.columns = first.columns;
      record.stride = first.stride;
      const std::size_t count = std::min(rows_at_once, rows.size() - row);
      for (std::size_t c = 0; c < first.columns; ++c)
        for (std::size_t r = 0; r < rows_at_once; ++r)
          matrix.push_back(r < count ? rows[row + r].entries[c * rows[row + r].stride] : 0.0);
      record.rows.fill(no_place);
      for (std::size_t r = 0; r < count; ++r) record.rows[r] = rows[row + r].place;
      made.push_back(record);
    }
  }
  return made;
}

// Arrays in a lane's room, each with a place more that nothing reads.
struct Room {
  explicit Room(std::uint32_t order) : degree(2 * order + 2), all(std::uint32_t(plan::harmonics(int(order))) + 1) {}

  std::uint32_t degree, all;
  std::uint32_t a() const { return 0; }
  std::uint32_t b() const { return degree; }
  std::uint32_t upright() const { return 2 * degree; }
  std::uint32_t shifted() const { return 2 * degree + all; }
  std::uint32_t places() const { return 2 * degree + 2 * all; }
};

void add(std::vector<TranslationRecord>& records, const std::vector<TranslationRecord>& products, std::uint32_t from,
         std::uint32_t to, std::uint32_t unread) {
  for (TranslationRecord record : products) {
    record.place += from;
    for (std::uint32_t& row : record.rows) row = row == no_place ? unread : row + to;
    records.push_back(record);
  }
}

} // namespace

TranslationProgram translation_program(const Translations& translations) {
  const int highest = translations.order();
  const Room room{std::uint32_t(highest)};
  const std::uint32_t a = room.a(), b = room.b(), upright = room.upright(), shifted = room.shifted();
  TranslationProgram program;
  program.places = room.places();
  struct Exchange {
    std::vector<TranslationRecord> flat, upright;
  };
  std::vector<Exchange> exchanges;
  for (const auto& blocks : translations.exchanges())
    exchanges.push_back({products(blocks.flat, translations.exchange_matrix(), program.matrix),
                         products(blocks.upright, translations.exchange_matrix(), program.matrix)});
  for (int order = 0; order <= highest; ++order) {
    std::vector<TranslationRecord> records;
    const auto step = [&](TranslationStep kind, std::uint32_t degree, std::uint32_t place) {
      records.push_back({kind, degree, place});
    };
    for (std::uint32_t l = 0; l <= std::uint32_t(order); ++l) {
      step(TranslationStep::take, l, a);
      add(records, exchanges[l].flat, a, b, upright - 1);
      step(TranslationStep::tilt, l, b);
      add(records, exchanges[l].upright, b, upright, shifted - 1);
    }
    const Translations::Shift& shift = translations.shift(plan::Translation::multipole_to_local, order);
    add(records, products(shift.blocks, shift.matrix.data(), program.matrix), upright, shifted, room.places() - 1);
    for (std::uint32_t l = 0; l <= std::uint32_t(order); ++l) {
      add(records, exchanges[l].flat, shifted + l * l, a, b - 1);
      step(TranslationStep::tilt_back, l, a);
      add(records, exchanges[l].flat, a, b, upright - 1);
      step(TranslationStep::give, l, b);
    }
    program.orders.push_back(std::move(records));
  }
  return program;
}

} // namespace cowgpu::gpu
