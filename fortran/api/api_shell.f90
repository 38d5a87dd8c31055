!> Shells of a model of api_sla_model in space.
!>
!> Nodes and elements are 1-based.
module api_shell
   use, intrinsic :: iso_c_binding, only : c_double, c_int, c_int64_t
   implicit none
   private
   public :: shells, axes_of

contains

   !> Layered flat shells of one kind
   subroutine shells(handle, kind, section, nodes, frame, flat, per, elements, connect, property, choice, bad, status)
      use common_status, only : status_bad_index, status_invalid_argument, status_out_of_memory, status_ok
      use shell_group, only : shell_points, shell_points_new, shell_section
      use sla_group, only : element_group
      use sla_handle, only : group_added, group_begun
      use sla_model, only : element_model
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: kind                      !! Q4 or T3 of the list sla_element
      !> List shell_through, layers, 1: bends (else a membrane), 1: in-plane shear strain from the middle
      integer(c_int), intent(in) :: section(4)
      integer(c_int), intent(in) :: nodes
      real(c_double), intent(in) :: frame(3, 3, nodes)        !! columns: axes of the rotations of a node
      integer(c_int), intent(in) :: flat(nodes)               !! 1: the shell is flat there, about its third axis
      integer(c_int), intent(in) :: per                       !! nodes of an element
      integer(c_int), intent(in) :: elements
      integer(c_int), intent(in) :: connect(per, elements)
      real(c_double), intent(in) :: property(14, elements)    !! as of `plane`, angles to the element's x
      integer(c_int), intent(in) :: choice(5, elements)       !! as of `plane`
      integer(c_int), intent(out) :: bad                      !! inverted element
      integer(c_int), intent(out) :: status
      type(element_model), pointer :: model
      type(shell_points), allocatable :: new_shells
      class(element_group), allocatable :: group
      integer :: info
      !f2py threadsafe
      bad = 0
      call group_begun(handle, connect, choice(1:4, :), model, status)
      if (status /= status_ok) return
      allocate (new_shells, stat=info)
      if (any(choice(5, :) < 0)) then
         status = status_bad_index
      else if (any(choice(2, :) > choice(3, :)) .or. per /= kind .or. (per /= 3 .and. per /= 4) .or. &
               any(property(8, :) > 0.0_c_double .and. choice(1, :) > 0 .and. choice(2, :) == 0) .or. &
               size(model%xy, 1) /= 3 .or. nodes /= model%nodes) then
         status = status_invalid_argument
      else if (info /= 0) then
         status = status_out_of_memory
      else
         call shell_points_new(kind, shell_section(section(1), section(2), section(3) /= 0), section(4) /= 0, &
            model%xy, frame, flat, connect, property, choice, model%teeth, model%options, new_shells, bad, status)
      end if
      call move_alloc(new_shells, group)
      call group_added(handle, model, connect, 6, group, status)
   end subroutine shells

   !> Axes of elements, rows x, y, normal: x is horizontal, y goes up
   subroutine axes_of(nodes, xyz, per, elements, connect, axes, bad, status)
      use common_status, only : status_bad_index, status_invalid_argument, status_ok
      use shell_element, only : shell_frame, most_corners
      integer(c_int), intent(in) :: nodes
      real(c_double), intent(in) :: xyz(3, nodes)             !! [m]
      integer(c_int), intent(in) :: per                       !! nodes of an element, 3 or 4
      integer(c_int), intent(in) :: elements
      integer(c_int), intent(in) :: connect(per, elements)
      real(c_double), intent(out) :: axes(3, 3, elements)
      integer(c_int), intent(out) :: bad                      !! an element without area
      integer(c_int), intent(out) :: status
      real(c_double) :: corner(3, most_corners)
      integer :: e, i
      axes = 0.0_c_double
      bad = 0
      status = status_bad_index
      if (any(connect < 1) .or. any(connect > nodes)) return
      status = status_invalid_argument
      if (per /= 3 .and. per /= 4) return
      status = status_ok
      do e = 1, elements
         do i = 1, per
            corner(:, i) = xyz(:, connect(i, e))
         end do
         call shell_frame(corner(:, 1:per), axes(:, :, e), status)
         if (status == status_ok) cycle
         bad = int(e, c_int)
         return
      end do
   end subroutine axes_of

end module api_shell
