!> The sparse factor of the C part (c/sparse/ldl.c).
module sla_c_bindings
   use, intrinsic :: iso_c_binding, only : c_double, c_int, c_int64_t, c_ptr
   implicit none
   private
   public :: extrados_sparse_order, extrados_sparse_new, extrados_sparse_free, extrados_sparse_factor
   public :: extrados_sparse_solve, extrados_sparse_change, extrados_sparse_backward, extrados_sparse_tree
   public :: extrados_sparse_plain, extrados_sparse_indefinite, extrados_sparse_again

   interface
      function extrados_sparse_order(n, start, row, ordering, order) bind(c) result(status)
         import :: c_int, c_int64_t
         implicit none (type, external)
         integer(c_int64_t), value, intent(in) :: n
         integer(c_int64_t), intent(in) :: start(*), row(*)
         integer(c_int), value, intent(in) :: ordering
         integer(c_int64_t), intent(out) :: order(*)
         integer(c_int) :: status
      end function extrados_sparse_order

      function extrados_sparse_new(n, start, row, handle, values) bind(c) result(status)
         import :: c_int, c_int64_t, c_ptr
         implicit none (type, external)
         integer(c_int64_t), value, intent(in) :: n
         integer(c_int64_t), intent(in) :: start(*), row(*)
         type(c_ptr), intent(out) :: handle
         integer(c_int64_t), intent(out) :: values
         integer(c_int) :: status
      end function extrados_sparse_new

      subroutine extrados_sparse_free(handle) bind(c)
         import :: c_ptr
         implicit none (type, external)
         type(c_ptr), intent(inout) :: handle
      end subroutine extrados_sparse_free

      function extrados_sparse_factor(handle, value, ratio, weakest) bind(c) result(status)
         import :: c_int, c_int64_t, c_double, c_ptr
         implicit none (type, external)
         type(c_ptr), value, intent(in) :: handle
         real(c_double), intent(in) :: value(*)
         real(c_double), intent(out) :: ratio
         integer(c_int64_t), intent(out) :: weakest
         integer(c_int) :: status
      end function extrados_sparse_factor

      function extrados_sparse_solve(handle, vectors, z) bind(c) result(status)
         import :: c_int, c_double, c_ptr
         implicit none (type, external)
         type(c_ptr), value, intent(in) :: handle
         integer(c_int), value, intent(in) :: vectors
         real(c_double), intent(inout) :: z(*)
         integer(c_int) :: status
      end function extrados_sparse_solve

      function extrados_sparse_change(handle, changes, sign, count, index, w, vectors, b, z, least) bind(c) &
         result(status)
         import :: c_int, c_double, c_ptr
         implicit none (type, external)
         type(c_ptr), value, intent(in) :: handle
         integer(c_int), value, intent(in) :: changes, count, vectors
         integer(c_int), intent(in) :: sign(*), index(*)
         real(c_double), intent(in) :: w(*), b(*)
         real(c_double), intent(inout) :: z(*)
         real(c_double), intent(out) :: least
         integer(c_int) :: status
      end function extrados_sparse_change

      function extrados_sparse_backward(handle, first, last, vectors, z) bind(c) result(status)
         import :: c_int, c_int64_t, c_double, c_ptr
         implicit none (type, external)
         type(c_ptr), value, intent(in) :: handle
         integer(c_int64_t), value, intent(in) :: first, last
         integer(c_int), value, intent(in) :: vectors
         real(c_double), intent(inout) :: z(*)
         integer(c_int) :: status
      end function extrados_sparse_backward

      subroutine extrados_sparse_tree(handle, blocks, column, start, row) bind(c)
         import :: c_int64_t, c_ptr
         implicit none (type, external)
         type(c_ptr), value, intent(in) :: handle
         integer(c_int64_t), intent(out) :: blocks
         type(c_ptr), intent(out) :: column, start, row
      end subroutine extrados_sparse_tree

      function extrados_sparse_plain(handle, value, vectors, z) bind(c) result(status)
         import :: c_int, c_double, c_ptr
         implicit none (type, external)
         type(c_ptr), value, intent(in) :: handle
         real(c_double), intent(in) :: value(*)
         integer(c_int), value, intent(in) :: vectors
         real(c_double), intent(inout) :: z(*)
         integer(c_int) :: status
      end function extrados_sparse_plain

      function extrados_sparse_indefinite(handle, value, vectors, z) bind(c) result(status)
         import :: c_int, c_double, c_ptr
         implicit none (type, external)
         type(c_ptr), value, intent(in) :: handle
         real(c_double), intent(in) :: value(*)
         integer(c_int), value, intent(in) :: vectors
         real(c_double), intent(inout) :: z(*)
         integer(c_int) :: status
      end function extrados_sparse_indefinite

      function extrados_sparse_again(handle, vectors, z) bind(c) result(status)
         import :: c_int, c_double, c_ptr
         implicit none (type, external)
         type(c_ptr), value, intent(in) :: handle
         integer(c_int), value, intent(in) :: vectors
         real(c_double), intent(inout) :: z(*)
         integer(c_int) :: status
      end function extrados_sparse_again
   end interface

end module sla_c_bindings
