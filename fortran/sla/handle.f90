!> Models behind integers, for callers that cannot hold a derived type.
module sla_handle
   use common_status, only : status_ok, status_out_of_memory
   use sla_model, only : model
   use, intrinsic :: iso_c_binding, only : c_int, c_int64_t, c_intptr_t, c_loc, c_ptr, c_f_pointer
   implicit none
   private
   public :: handle_of, model_of, both_directions

contains

   !> The handle of a model
   function handle_of(made) result(handle)
      type(model), pointer, intent(in) :: made
      integer(c_int64_t) :: handle
      handle = int(transfer(c_loc(made), 0_c_intptr_t), c_int64_t)
   end function handle_of

   !> The model of a handle
   function model_of(handle) result(made)
      integer(c_int64_t), intent(in) :: handle
      type(model), pointer :: made
      type(c_ptr) :: address
      address = transfer(int(handle, c_intptr_t), address)
      call c_f_pointer(address, made)
   end function model_of

   !> Node and direction of each freedom of elements whose nodes move in x and y
   subroutine both_directions(connect, node, direction, status)
      integer(c_int), intent(in) :: connect(:, :)                    !! (nodes, elements)
      integer(c_int), allocatable, intent(out) :: node(:, :)         !! (2 nodes, elements)
      integer(c_int), allocatable, intent(out) :: direction(:, :)
      integer(c_int), intent(out) :: status
      integer :: i, info
      allocate (node(2 * size(connect, 1), size(connect, 2)), direction(2 * size(connect, 1), size(connect, 2)), &
         stat=info)
      status = merge(status_ok, status_out_of_memory, info == 0)
      if (info /= 0) return
      do i = 1, size(connect, 1)
         node(2 * i - 1, :) = connect(i, :)
         node(2 * i, :) = connect(i, :)
         direction(2 * i - 1, :) = 1
         direction(2 * i, :) = 2
      end do
   end subroutine both_directions

end module sla_handle
