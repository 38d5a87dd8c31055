!> Sequentially linear analysis: joints of no thickness for a model of api_sla_model.
!>
!> Nodes and elements are 1-based.
module api_sla_joints
   use, intrinsic :: iso_c_binding, only : c_double, c_int, c_int64_t
   implicit none
   private
   public :: joints, joints_between_shells

contains

   !> Joints of no thickness in the plane; their tooth tables measure openings (band 1)
   subroutine joints(handle, elements, connect, property, choice, ripple, bad, status)
      use sla_joint_handle, only : joints_added
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: elements
      integer(c_int), intent(in) :: connect(4, elements)      !! along the lower, back along the upper side
      !> Areas of the two points [m^2] (0: it stands in the neighbour), normal stiffness, shear stiffness [Pa/m],
      !> friction (negative: no sliding), stress that counts as small [Pa], cosine and sine of the normal
      real(c_double), intent(in) :: property(8, elements)
      !> Tables of tension, compression and cohesion teeth, 0 none; 1: no tensile strength
      integer(c_int), intent(in) :: choice(4, elements)
      real(c_double), intent(in) :: ripple                    !! half-width of the steps of friction over the friction
      integer(c_int), intent(out) :: bad                      !! element without area or normal
      integer(c_int), intent(out) :: status
      real(c_double) :: none(0, 3, 0)
      !f2py threadsafe
      call joints_added(handle, connect, property, choice, ripple, none, bad, status)
   end subroutine joints

   !> Joints between shells; an element is one layer of a stretch, and arguments are those of `joints`
   subroutine joints_between_shells(handle, elements, connect, property, choice, ripple, row, bad, status)
      use sla_joint_handle, only : joints_added
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: elements
      integer(c_int), intent(in) :: connect(4, elements)
      real(c_double), intent(in) :: property(8, elements)     !! cosine and sine within the plane of the wall
      integer(c_int), intent(in) :: choice(4, elements)
      real(c_double), intent(in) :: ripple
      !> Of the freedoms of an element the jumps across, along and out of the plane at its two points; the last stays
      !> elastic, with the shear stiffness
      real(c_double), intent(in) :: row(24, 3, 2 * elements)
      integer(c_int), intent(out) :: bad
      integer(c_int), intent(out) :: status
      !f2py threadsafe
      call joints_added(handle, connect, property, choice, ripple, row, bad, status)
   end subroutine joints_between_shells

end module api_sla_joints
