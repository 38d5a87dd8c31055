!> The energy balance: work of the ground, kinetic, stored and dissipated energy.
!>
!> Leap-frog conserves m v(n-1/2) v(n+1/2) / 2 plus the potential of linear springs and gravity exactly;
!> the residual is taken with this kinetic energy, so that it shows true gain or loss and not the
!> offset of half a step. Work is booked with the trapezoidal rule over each position step.
module dem_energy
   use common_kinds, only : wp
   use common_lists, only : dem_energy_count, dem_energy_kinetic, dem_energy_potential, dem_energy_elastic, &
      dem_energy_friction, dem_energy_damping, dem_energy_mass_damping, dem_energy_work, dem_energy_residual, &
      dem_energy_leapfrog
   implicit none
   private
   public :: energy_terms, energy_residual, energy_row

   type :: energy_terms
      real(wp) :: kinetic = 0.0_wp        !! [J], at the time of the forces
      real(wp) :: leapfrog = 0.0_wp       !! [J], the conserved form
      real(wp) :: potential = 0.0_wp      !! of gravity and constant loads, 0 at rest [J]
      real(wp) :: elastic = 0.0_wp        !! in the springs [J]
      real(wp) :: friction = 0.0_wp       !! lost by sliding and by breaking [J]
      real(wp) :: damping = 0.0_wp        !! lost in dashpots, or by impacts of rigid contacts [J]
      real(wp) :: mass_damping = 0.0_wp   !! lost by mass-proportional damping [J]
      real(wp) :: work = 0.0_wp           !! done by the ground and the supports [J]
   end type energy_terms

contains

   !> Energy that came from nowhere since the start [J]
   pure function energy_residual(energy, start) result(r)
      type(energy_terms), intent(in) :: energy
      type(energy_terms), intent(in) :: start
      real(wp) :: r
      r = (energy%leapfrog - start%leapfrog) + (energy%potential - start%potential) + (energy%elastic - start%elastic) &
         + (energy%friction - start%friction) + (energy%damping - start%damping) &
         + (energy%mass_damping - start%mass_damping) - (energy%work - start%work)
   end function energy_residual

   !> The energy balance as the rows of the list dem_energy [J]
   pure function energy_row(energy, start) result(row)
      type(energy_terms), intent(in) :: energy
      type(energy_terms), intent(in) :: start
      real(wp) :: row(dem_energy_count)
      row(dem_energy_kinetic) = energy%kinetic
      row(dem_energy_potential) = energy%potential
      row(dem_energy_elastic) = energy%elastic
      row(dem_energy_friction) = energy%friction
      row(dem_energy_damping) = energy%damping
      row(dem_energy_mass_damping) = energy%mass_damping
      row(dem_energy_work) = energy%work
      row(dem_energy_residual) = energy_residual(energy, start)
      row(dem_energy_leapfrog) = energy%leapfrog
   end function energy_row

end module dem_energy
