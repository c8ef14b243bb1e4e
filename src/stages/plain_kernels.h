// The kernels of the stage bodies that a backend may do in its own way, and what each computes: one thread an element,
// written once over an executor. It is the reference that every other set is compared with.
//
// A body asks for a kernel by Exec::Kernels::Name. The set is a type, so it is part of the executor's type and of every
// body's: what a source file includes cannot change which kernel a body gets. Kernels are only declared here. A source
// file that instantiates a body without the header of one of its kernels does not compile.
#pragma once

namespace isoshell {

struct PlainLabelSheet;

struct PlainKernels {
  using LabelSheet = PlainLabelSheet;  ///< label_body.h
};

}  // namespace isoshell
