// Hard accounting of anonymous memory: what a builder plans to hold it reserves first, so that a run that cannot fit
// says so before it starts instead of dying on the way. Mapped input is not counted.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

namespace tet4d::outofcore {

// "1536 B", "1.5 KiB", "2.0 GiB".
std::string bytesText(std::uint64_t bytes);

// Thread-safe. Costs an atomic addition a reservation: reserve blocks, not items.
class MemoryBudget {
 public:
  // 0 = no limit; then it only counts.
  explicit MemoryBudget(std::uint64_t limit_bytes = 0) : limit_(limit_bytes) {}
  MemoryBudget(const MemoryBudget&) = delete;
  MemoryBudget& operator=(const MemoryBudget&) = delete;

  // A part of the budget; gives it back when destroyed. The budget must outlive it.
  class Reservation {
   public:
    Reservation() = default;
    Reservation(Reservation&& other) noexcept
        : budget_(std::exchange(other.budget_, nullptr)), bytes_(std::exchange(other.bytes_, 0)) {}
    Reservation& operator=(Reservation&& other) noexcept {
      std::swap(budget_, other.budget_), std::swap(bytes_, other.bytes_);
      return *this;
    }
    ~Reservation() {
      if (budget_ != nullptr) budget_->used_ -= bytes_;
    }
    std::uint64_t bytes() const { return bytes_; }

   private:
    friend class MemoryBudget;
    Reservation(MemoryBudget* budget, std::uint64_t bytes) : budget_(budget), bytes_(bytes) {}
    MemoryBudget* budget_ = nullptr;
    std::uint64_t bytes_ = 0;
  };

  // Throws Error{kOutOfMemory} that names `what`, the bytes needed, in use and allowed, and the least --memory that
  // would do.
  [[nodiscard]] Reservation reserve(std::uint64_t bytes, std::string_view what);

  std::uint64_t limit() const { return limit_; }  // 0 = none
  std::uint64_t used() const { return used_; }
  std::uint64_t peak() const { return peak_; }
  // Bytes left; the largest number if there is no limit.
  std::uint64_t available() const;

 private:
  std::uint64_t limit_;
  std::atomic<std::uint64_t> used_{0};
  std::atomic<std::uint64_t> peak_{0};
};

}  // namespace tet4d::outofcore
