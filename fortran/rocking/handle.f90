!> Lists of rocking structures behind handles, for callers that cannot hold a derived type.
module rocking_handle
   use common_handles, only : handle_new, handle_take
   use common_kinds, only : wp
   use common_lists, only : handle_rocking
   use common_status, only : status_ok, status_bad_index, status_invalid_argument, status_not_finite, &
      status_out_of_memory
   use rocking_ensemble, only : body_list
   use, intrinsic :: iso_c_binding, only : c_f_pointer, c_funloc, c_int, c_int64_t, c_loc, c_null_ptr, c_ptr
   implicit none
   private
   public :: body_list_new, body_list_destroy, body_list_take, set_body

contains

   !> Room for `count` structures
   subroutine body_list_new(count, handle, status)
      integer(c_int), intent(in) :: count
      integer(c_int64_t), intent(out) :: handle
      integer(c_int), intent(out) :: status
      type(body_list), pointer :: list
      integer :: failed
      handle = 0
      status = status_invalid_argument
      if (count < 1) return
      status = status_out_of_memory
      allocate (list, stat=failed)
      if (failed /= 0) return
      allocate (list%item(count), stat=failed)
      if (failed == 0) call handle_new(handle_rocking, c_loc(list), c_funloc(body_list_destroy), handle, status)
      if (status /= status_ok) deallocate (list)
   end subroutine body_list_new

   !> Called by the registry
   subroutine body_list_destroy(object) bind(c, name='extrados_rocking_destroy')
      type(c_ptr), value, intent(in) :: object
      type(body_list), pointer :: list
      call c_f_pointer(object, list)
      deallocate (list)
   end subroutine body_list_destroy

   !> The list of a handle, until handle_leave; null where the status is not ok
   subroutine body_list_take(handle, alone, list, status)
      integer(c_int64_t), intent(in) :: handle
      logical, intent(in) :: alone                   !! this call changes it
      type(body_list), pointer, intent(out) :: list
      integer(c_int), intent(out) :: status
      type(c_ptr) :: object
      list => null()
      object = c_null_ptr
      call handle_take(handle, handle_rocking, alone, object, status)
      if (status == status_ok) call c_f_pointer(object, list)
   end subroutine body_list_take

   !> Structure `number` of a list
   subroutine set_body(list, number, kind, parameters, status)
      type(body_list), intent(inout) :: list
      integer(c_int), intent(in) :: number           !! 1-based
      integer(c_int), intent(in) :: kind             !! rocking_body_... of common_lists
      real(wp), intent(in) :: parameters(:)          !! of the kind
      integer(c_int), intent(out) :: status
      real(wp), allocatable :: copy(:)
      integer :: failed
      status = status_bad_index
      if (number < 1 .or. number > size(list%item)) return
      status = status_not_finite
      if (.not. all(abs(parameters) <= huge(1.0_wp))) return
      status = status_out_of_memory
      allocate (copy(size(parameters)), stat=failed)
      if (failed /= 0) return
      copy(:) = parameters
      list%item(number)%kind = kind
      call move_alloc(copy, list%item(number)%parameters)
      status = status_ok
   end subroutine set_body

end module rocking_handle
