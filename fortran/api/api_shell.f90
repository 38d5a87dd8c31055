!> Shells of a model of api_sla_model in space.
!>
!> Nodes and elements are 1-based.
module api_shell
   use, intrinsic :: iso_c_binding, only : c_double, c_int, c_int64_t
   implicit none
   private
   public :: shells, axes_of, layers_of

contains

   !> Layered flat shells of one kind
   subroutine shells(handle, kind, section, nodes, frame, flat, per, elements, connect, property, choice, bad, status)
      use shell_group, only : shell_section
      use shell_handle, only : shells_added
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
      !f2py threadsafe
      call shells_added(handle, kind, shell_section(section(1), section(2), section(3) /= 0), section(4) /= 0, frame, &
         flat, connect, property, choice, bad, status)
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

   !> Where the layers of a shell lie, in thicknesses over the middle, and their shares of the thickness
   subroutine layers_of(through, layers, height, share, status)
      use shell_layers, only : layers_new, most_layers
      integer(c_int), intent(in) :: through                   !! of the list shell_through
      integer(c_int), intent(in) :: layers                    !! 1 to 15
      real(c_double), intent(out) :: height(15)               !! zero beyond `layers`
      real(c_double), intent(out) :: share(15)
      integer(c_int), intent(out) :: status
      real(c_double) :: z(most_layers), w(most_layers)
      call layers_new(through, layers, z, w, status)
      height(:) = z
      share(:) = w
   end subroutine layers_of

end module api_shell
