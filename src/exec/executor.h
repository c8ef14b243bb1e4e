// What an executor must offer. Stage bodies are templates over one; they see nothing else of the machine.
//
//   using Kernels = ...;                                             // what bodies call: stages/plain_kernels.h
//   Context& context();                                              // of the run: options, progress, cancellation
//   template <class T> Buffer<T> make(int64_t count);               // not initialised
//   template <class T> void fill(View<T> out, T value);
//   template <class T> void copy(View<const T> from, View<T> to);    // equal sizes, no overlap
//   template <class T> T value(View<const T> values, int64_t i);     // one element, on the host: waits for the steps
//   template <class Step> void for_each(const char* name, int64_t count, Step step);   // step(int64_t i), any order
//   template <class T> T exclusive_scan(View<T> counts);             // in place; returns the total
//   template <class T, class Term> T exclusive_scan_of(int64_t count, Term term, View<T> out);
//                                                                    // out[i]: the sum of term(j), j < i; returns the
//                                                                    // total, which out[count] gets where it exists
//   template <class T> void inclusive_scan(View<T> counts);          // in place
//   template <class T, class Less> void sort(View<T> keys, Less less);   // less must be a total order on the values
//   template <class Keep> Buffer<uint32_t> select(int64_t count, Keep keep); // ascending i with keep(i)
//   template <class Term> int64_t sum(int64_t count, Term term);     // integer sum of term(i)
//   template <class Term> void sum_into(View<int64_t> out, int64_t count, Term term);   // the same, to out[0]
//   static constexpr int kPassBatch;                                 // passes of a loop between two looks at its state
//
// All but make, value and a device's copy throw Error{interrupted} before they begin when the context was cancelled: no
// work is left to a device that nobody waits for. They may throw it at their end, too: for_each then skipped elements.
//
// Every operation has one mathematical answer, so no schedule can change a byte. Steps are functors named for what they
// do. A step may write only to its own elements, or through the integer atomics of voxel/atomic.h.
#pragma once
