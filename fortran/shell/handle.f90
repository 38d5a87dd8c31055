!> Shells of a model of sla_handle.
module shell_handle
   use common_kinds, only : wp
   use common_status, only : status_bad_index, status_invalid_argument, status_out_of_memory, status_ok
   use shell_group, only : shell_points, shell_points_new, shell_section
   use sla_group, only : element_group
   use sla_handle, only : group_added, group_begun
   use sla_model, only : element_model
   use, intrinsic :: iso_c_binding, only : c_int, c_int64_t
   implicit none
   private
   public :: shells_added

contains

   !> Add layered flat shells of one kind to a model in space
   subroutine shells_added(handle, kind, section, selective, frame, flat, connect, property, choice, bad, status)
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: kind            !! Q4 or T3 of the list sla_element
      type(shell_section), intent(in) :: section
      logical, intent(in) :: selective              !! in-plane shear strain of quadrilaterals from the middle
      real(wp), intent(in) :: frame(:, :, :)        !! (3, 3, nodes) columns: axes of a node's rotations
      integer(c_int), intent(in) :: flat(:)         !! (nodes) 1: the shell is flat there
      integer(c_int), intent(in) :: connect(:, :)   !! (nodes of an element, elements), 1-based
      real(wp), intent(in) :: property(:, :)        !! (14, elements) as of plane elements
      integer(c_int), intent(in) :: choice(:, :)    !! (5, elements) as of plane elements
      integer(c_int), intent(out) :: bad            !! the offending element, 1-based
      integer(c_int), intent(out) :: status
      type(element_model), pointer :: model
      type(shell_points), allocatable :: shells
      class(element_group), allocatable :: group
      integer :: info
      bad = 0
      call group_begun(handle, connect, choice(1:4, :), model, status)
      if (status /= status_ok) return
      allocate (shells, stat=info)
      if (any(choice(5, :) < 0)) then
         status = status_bad_index
      else if (any(choice(2, :) > choice(3, :)) .or. size(connect, 1) /= kind .or. &
               (size(connect, 1) /= 3 .and. size(connect, 1) /= 4) .or. &
               any(property(8, :) > 0.0_wp .and. choice(1, :) > 0 .and. choice(2, :) == 0) .or. &
               size(model%mesh%xy, 1) /= 3 .or. size(flat) /= model%mesh%nodes) then
         status = status_invalid_argument
      else if (info /= 0) then
         status = status_out_of_memory
      else
         call shell_points_new(kind, section, selective, model%mesh%xy, frame, flat, connect, property, choice, &
            model%mesh%teeth, model%mesh%options, shells, bad, status)
      end if
      call move_alloc(shells, group)
      call group_added(handle, model, connect, 6, group, status)
   end subroutine shells_added

end module shell_handle
