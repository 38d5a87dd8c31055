!> Objects that live between calls, behind numbers: the registry of c/common/handles.c.
!>
!> A facade takes the object of a handle at its start and leaves it at its end; the registry refuses handles that
!> are closed, of another kind, or in use by another call.
module common_handles
   use common_c_bindings, only : extrados_handle_new, extrados_handle_take, extrados_handle_leave, extrados_handle_close
   use, intrinsic :: iso_c_binding, only : c_funptr, c_int, c_int64_t, c_ptr
   implicit none
   private
   public :: handle_new, handle_take, handle_leave, handle_close

contains

   !> Register an object
   subroutine handle_new(kind, object, destroy, handle, status)
      integer(c_int), intent(in) :: kind             !! handle_... of common_lists
      type(c_ptr), value, intent(in) :: object
      type(c_funptr), value, intent(in) :: destroy   !! bind(c) subroutine (type(c_ptr), value) that frees it
      integer(c_int64_t), intent(out) :: handle      !! 0 where it failed
      integer(c_int), intent(out) :: status
      status = extrados_handle_new(kind, object, destroy, handle)
   end subroutine handle_new

   !> The object of a handle, until handle_leave
   subroutine handle_take(handle, kind, alone, object, status)
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: kind             !! handle_... of common_lists
      logical, intent(in) :: alone                   !! this call changes the object: nobody else may use it
      type(c_ptr), intent(out) :: object
      integer(c_int), intent(out) :: status          !! closed_handle, wrong_handle or busy: nothing was taken
      status = extrados_handle_take(handle, kind, merge(1_c_int, 0_c_int, alone), object)
   end subroutine handle_take

   !> The call no longer uses the object
   subroutine handle_leave(handle)
      integer(c_int64_t), intent(in) :: handle
      call extrados_handle_leave(handle)
   end subroutine handle_leave

   !> Destroy an object
   subroutine handle_close(handle, later, status)
      integer(c_int64_t), intent(in) :: handle
      logical, intent(in) :: later                   !! where a call uses it, destroy it as that call leaves
      integer(c_int), intent(out) :: status          !! closed_handle, or busy where a call uses it
      status = extrados_handle_close(handle, merge(1_c_int, 0_c_int, later))
   end subroutine handle_close

end module common_handles
